"""Lets a script that is run by hand import this checkout, and what the tests share; pytest does so by its own settings."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), *(str(Path(__file__).parents[1] / room) for room in ("", "helpers", "inputs", "limit"))]
