"""Damaged files are read, or refused with a message. Inputs that once had another outcome are kept here by name."""

import os
import random
import signal
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import fuzz_readers
import pytest
from fuzz_readers import READ, REFUSED, Reader

from la_core.analysis.modelling import structural_model
from la_core.errors import SceneError
from la_core.scene.scene import scene_of_text
from la_core.scene.shipped import find

FEW, COUNT = 60, 200  # inputs for each reader, in quick runs and in all; `python tests/benchmarks/fuzz_readers.py --count 10000` takes more


@pytest.fixture(scope="module")
def readers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Reader]:
    return {reader.name: reader for reader in fuzz_readers.readers(tmp_path_factory.mktemp("fuzz"))}


NAMES = (
    "scene", "obj", "ply", "stl text", "stl", "compas", "old compas", "dxf", "svg", "new", "case.h5", "case.h5 forged", "run.h5",
    "run.h5 forged",
)  # fmt: skip


@pytest.mark.yade
def test_every_reader_is_tried(readers: dict[str, Reader]) -> None:
    assert tuple(readers) == NAMES


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("numbers", [range(FEW), pytest.param(range(FEW, COUNT), marks=pytest.mark.slow)], ids=["few", "more"])
def test_a_damaged_file_is_read_or_refused_in_words(numbers: range, name: str, readers: dict[str, Reader]) -> None:
    found = Counter(outcome for _, outcome in fuzz_readers.outcomes(readers[name], numbers))
    assert set(found) <= {READ, REFUSED}, found
    assert found[REFUSED] > len(numbers) / 4  # the damage is real


def _refused() -> None:
    raise SceneError("", "as it should be")


def _endless() -> None:
    while True:
        pass


DEEDS: tuple[tuple[Callable[[], object], str], ...] = (
    (int, READ), (_endless, "took too long"), (_refused, REFUSED), (lambda: os.kill(os.getpid(), signal.SIGKILL), "died: SIGKILL"),
    (lambda: bytearray(10**12), "MemoryError: "), (lambda: 1 / 0, "ZeroDivisionError: division by zero"), (int, READ),
)  # fmt: skip


def test_what_dies_or_takes_too_long_is_counted_and_the_next_input_follows(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tool detects every outcome that it looks for."""
    monkeypatch.setattr(fuzz_readers, "SECONDS", 0.2)
    deeds = {random.Random(f"bad {number}").random(): deed for number, (deed, _) in enumerate(DEEDS)}
    reader = Reader("bad", "", lambda chance: deeds[chance.random()]() and None)
    assert list(fuzz_readers.outcomes(reader, range(len(DEEDS)))) == [(number, said) for number, (_, said) in enumerate(DEEDS)]


REPLACED = {
    "a number of too many digits": ("two_pads", "friction = 0.6", f"friction = {'9' * 5000}", "not valid TOML"),
    "a slab as thin as round-off": ("slab_four_corners", "0.1] }", "1e-308] }", "which is round-off"),
    "an arch as thin as round-off": ("arch_spreading", "thickness = 0.3", "thickness = 3e-10", 'arch "arch": the profile has no area'),
    "a vault as thin as round-off": ("vault_spreading", "thickness = 0.3", "thickness = 3e-10", 'vault "vault": the profile has no area'),
}


@pytest.mark.parametrize(("name", "old", "new", "words"), REPLACED.values(), ids=REPLACED)
def test_a_scene_that_was_no_scene_is_refused(name: str, old: str, new: str, words: str) -> None:
    text = find(name).read_text()
    assert old in text
    with pytest.raises(SceneError, match=words):
        structural_model(scene_of_text(text.replace(old, new, 1), Path("scene.toml"), "scene"))
