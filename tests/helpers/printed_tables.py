"""Reads the tables that a command prints."""


def names_in(printed: str) -> list[str]:
    """Return the names of the rows of printed tables."""
    return [line.split("   ")[0].strip() for line in printed.splitlines() if line.startswith("  ") and line.strip()]
