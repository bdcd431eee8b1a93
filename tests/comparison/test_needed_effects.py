"""A run restores an effect if its guard fails, the scene leaves the effect open, and the end of the run lets it be judged."""

from types import SimpleNamespace
from typing import Any

import pytest

from comparison.verdict import Check, Verdict
from comparison.workflow import restored_effects
from la_core.limit import Status

EFFECTS = ("displacement", "friction", "plane", "reach")


@pytest.fixture(autouse=True)
def failing_guards(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the guards of all effects fail."""
    for name in ("displacement", "plane", "reach"):
        check = Check(name, Verdict.INCONCLUSIVE, reason=f"{name} fails.")
        monkeypatch.setattr(restored_effects, f"check_{name}", lambda _, check=check: iter([check]))
    monkeypatch.setattr(restored_effects, "slides_unforeseen", lambda _: True)


def ended(run: str = "plateau", bound: Status = Status.SOLVED, **effects: Any) -> Any:
    """Return results of a run with this status. `effects` has the choices of the scene that are not "auto"."""
    choices = SimpleNamespace(**({"elasticity": "auto"} | dict.fromkeys(EFFECTS, "auto") | effects))
    scene, modelled = SimpleNamespace(effects=choices), SimpleNamespace(called_back=("plane",), plane=False, reasons={"plane": "fails."})
    analysis = SimpleNamespace(main="main", bounds={"main": SimpleNamespace(status=bound)}, assembly=SimpleNamespace(effects=modelled))
    return SimpleNamespace(scene=scene, analysis=analysis, recorded=SimpleNamespace(status=run))


@pytest.mark.parametrize(
    ("results", "expected"),
    [
        (ended(), set(EFFECTS)),
        (ended("no plateau"), {"displacement"}),
        (ended("collapsed"), {"displacement"}),
        (ended(elasticity="none"), set()),
        (ended(bound=Status.INFEASIBLE), set()),
        (ended(plane=True, friction="associated"), {"displacement", "reach"}),
    ],
)
def test_an_effect_comes_back_where_its_guard_fails_and_the_scene_leaves_it_open(results: Any, expected: set[str]) -> None:
    found = restored_effects.needed(results)
    assert set(found) == expected
    choices = {"displacement": "finite", "friction": "coulomb", "plane": False, "reach": False}
    assert {effect: choice for effect, (choice, _) in found.items()} == {effect: choices[effect] for effect in expected}


def test_what_was_called_back_before_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(restored_effects, "_analyse_with", lambda _, restored: restored)
    again: Any = restored_effects.restore(ended("no plateau"))
    assert list(again) == ["plane", "displacement"] and again["plane"] == (False, "fails.")
    assert restored_effects.restore(ended(bound=Status.INFEASIBLE)) is None
