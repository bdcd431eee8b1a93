"""A result cannot be changed in place: its arrays and its tables are read-only, also in copies and in other processes."""

import copy
import pickle
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
import scenes

from la_core.analysis import analyse
from la_core.analysis.result import LimitAnalysis
from la_core.scene.scene import Scene


@pytest.fixture(scope="module")
def analysis() -> LimitAnalysis:
    return analyse(scenes.shipped("wall_third"))


def parts(value: Any, path: str = "analysis") -> Iterator[tuple[str, Any]]:
    """All values of a result with their paths, including those of its records and tables. Scenes have tests of their own."""
    yield path, value
    if isinstance(value, MappingProxyType):
        for name, item in value.items():
            yield from parts(item, f"{path}[{name}]")
    elif is_dataclass(value) and not isinstance(value, Scene):
        for field in fields(value):
            yield from parts(getattr(value, field.name), f"{path}.{field.name}")


@pytest.mark.parametrize(
    "same", [lambda it: it, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))], ids=["itself", "copy", "unpickled"]
)
def test_no_part_of_a_result_can_be_changed(same: Any, analysis: LimitAnalysis) -> None:
    found = list(parts(same(analysis)))
    arrays = {path: value for path, value in found if isinstance(value, np.ndarray)}
    assert len(arrays) > 50 and [path for path, value in arrays.items() if value.flags.writeable] == []
    assert [path for path, value in found if isinstance(value, dict | list)] == []


def test_a_bound_cannot_be_exchanged(analysis: LimitAnalysis) -> None:
    with pytest.raises(TypeError, match="does not support item assignment"):
        analysis.bounds[analysis.main] = None  # type: ignore[index]
    with pytest.raises(ValueError, match="read-only"):
        analysis.bounds[analysis.main].forces[0] = 0.0
