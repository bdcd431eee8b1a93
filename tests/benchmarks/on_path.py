"""Lets a script that is run by hand import this checkout and the shared modules of the tests. pytest has settings for this."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parents[2]), *(str(Path(__file__).parents[1] / room) for room in ("", "helpers", "inputs", "limit"))]
