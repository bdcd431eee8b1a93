"""Files of the exchange for tests: one of made-up fields, and the case of a small wall."""

from pathlib import Path

import numpy as np
import scenes

from la_core import exchange
from la_core.analysis.case_file import scene_digest, write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.exchange.fields import Field
from la_core.scene.scene import Scene

FIELDS = (
    Field("a/number", "f8", (), "N", "a number"),
    Field("a/count", "i8", (), "", "a count"),
    Field("a/flag", "u1", (), "", "a flag"),
    Field("a/text", "str", (), "", "a text"),
    Field("b/names", "str", ("B",), "", "names"),
    Field("b/vectors", "f8", ("B", 3), "m", "vectors"),
)
VALUES = {
    "a/number": 1.25,
    "a/count": 7,
    "a/flag": True,
    "a/text": "Tässä – ψ",
    "b/names": ["one", "zwei", "três"],
    "b/vectors": np.arange(9.0).reshape(3, 3),
}


def write_whole(folder: Path) -> Path:
    """Write a file of the made-up fields and return its path."""
    path = folder / "file.h5"
    exchange.write(path, FIELDS, VALUES, "digest")
    return path


def write_wall(folder: Path) -> tuple[Path, Scene, LimitAnalysis]:
    """Write the case of a small wall. Return its path, its scene and its limit analysis."""
    scene = scenes.build(*scenes.wall(3, 4, split=0.8), inset=0.001)
    analysis = analyse(scene)
    path = folder / "case.h5"
    write_case(path, analysis, scene_digest(scene))
    return path, scene, analysis
