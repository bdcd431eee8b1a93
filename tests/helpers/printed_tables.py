"""What tests read from the tables that a command prints."""


def names_in(printed: str) -> list[str]:
    """Names of the rows of printed tables."""
    return [line.split("   ")[0].strip() for line in printed.splitlines() if line.startswith("  ") and line.strip()]
