"""Complaints a user can act on."""

import difflib
from collections.abc import Iterable


class SceneError(Exception):
    """A scene that cannot be analysed: says file, key or block, value, rule and what to do next."""

    def __init__(self, where: str, rule: str, *, value: object = None, hint: str = "") -> None:
        shown = "" if value is None else f" = {_short(value)}"
        super().__init__(f"{where}{shown}: {rule}" + (f"; {hint}" if hint else ""))


def nearest(word: str, valid: Iterable[str], kind: str = "keys") -> str:
    """A hint with the valid key (or other `kind`) nearest to `word`, and all valid ones when none is near."""
    choices = list(valid)
    near = difflib.get_close_matches(word, choices, n=1, cutoff=0.5)
    return f'did you mean "{near[0]}"?' if near else f"valid {kind}: {', '.join(choices)}"


def _short(value: object, limit: int = 80) -> str:
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= limit else text[: limit - 3] + "..."
