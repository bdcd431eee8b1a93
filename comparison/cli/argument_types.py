"""Types of the values on the command line; each raises argparse's error for an invalid text."""

import argparse
from collections.abc import Callable
from pathlib import Path

from comparison.run_folder import FIGURE_FORMATS, MOST_FRAMES, MOVING_FORMATS, require_folder_of
from comparison.settings import MOST_WORKERS
from la_core.errors import OF_LOCALE, is_of_locale, visible
from la_core.scene import LEAST_ACCURACY, MOST_ACCURACY

PAGE_FORMATS = (".html", ".md", ".json")


def given_path(text: str) -> Path:
    """Parse the path of a file or folder: any text but an empty one, which would mean the current folder."""
    if not text:
        raise argparse.ArgumentTypeError('"": must be the path of a file or folder; an unset variable of the shell gives an empty text')
    return Path(text)


def address(text: str) -> str:
    """Parse the address of a scheduler: any text but an empty one, which would run everything on this machine."""
    if not text:
        raise argparse.ArgumentTypeError('"": must be the address of a scheduler; an unset variable of the shell gives an empty text')
    return text


def ending_in(endings: tuple[str, ...], what: str) -> Callable[[str], Path]:
    """Return a type for paths to write, with one of these endings; `what` names the file in the error message, such as 'a figure'.

    The type raises SceneError for a path whose folder does not exist.
    """

    def path_of(text: str) -> Path:
        path = given_path(text)
        if path.suffix not in endings:
            *others, last = endings
            choices = f"{', '.join(others)} or {last}" if others else last
            raise argparse.ArgumentTypeError(f"{text}: {what}'s name ends in {choices}")
        require_folder_of(path)  # refused before the work of the command, which would be lost
        return path

    return path_of


figure = ending_in(FIGURE_FORMATS, "a figure")
moving_picture = ending_in(MOVING_FORMATS, "an animation")
page = ending_in(PAGE_FORMATS, "a page")
scene_file = ending_in((".toml",), "a scene file")


def words(text: str) -> str:
    """Parse a text for a report: as in a scene file, without control characters and in UTF-8."""
    if visible(text) != text:
        rule = OF_LOCALE if is_of_locale(text) else "must be text without control characters, in UTF-8"
        raise argparse.ArgumentTypeError(f"{visible(text)}: {rule}")
    return text


def frames_per_second(text: str) -> int:
    """Parse a frame rate: a whole number from 1 to MOST_FRAMES."""
    value = int(text) if text.isdecimal() else 0
    if not 1 <= value <= MOST_FRAMES:
        raise argparse.ArgumentTypeError(f"{text}: must be a whole number from 1 to {MOST_FRAMES}")
    return value


def accuracy(text: str) -> float:
    """Parse a share such as "1%" or "0.01", from LEAST_ACCURACY to MOST_ACCURACY."""
    number, percent = text.strip().removesuffix("%"), text.strip().endswith("%")
    try:
        value = round(float(number) / (100.0 if percent else 1.0), 12)
    except ValueError:
        value = 0.0
    if not LEAST_ACCURACY <= value <= MOST_ACCURACY:
        raise argparse.ArgumentTypeError(f"{text}: must be a share from {LEAST_ACCURACY:.1%} to {MOST_ACCURACY:.0%}, such as 1%")
    return value


def count(text: str) -> int:
    """Parse a whole number from 1 to MOST_WORKERS."""
    if not (text.isdecimal() and 1 <= int(text[:9]) <= MOST_WORKERS):
        raise argparse.ArgumentTypeError(f"{text}: must be a whole number from 1 to {MOST_WORKERS}")
    return int(text)


def seconds(text: str) -> float:
    """Parse a positive, finite number of seconds."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: must be a positive number of seconds")
    return value
