"""Limit analysis of one scene as a table of texts."""

from collections.abc import Iterator
from typing import Any

from la_core.scene import Scene
from la_core.text_table import number, over_weight


def headings(scene: Scene) -> tuple[str, str, str]:
    """Headings of the three columns."""
    return "limit analysis", scene.unit or "value", "over W" if scene.live is None else ""


def rows(scene: Scene, values: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Name, value in its unit and over the weight, of what limit analysis says by the names of `answer_values`, with its residuals."""
    answer = values["associated"]
    yield "status", answer["status"], ""
    for name in (scene.quantity, "reaction_max", f"{scene.quantity}_sharp", "reaction_max_sharp"):
        if name in answer:
            yield _quantity(scene, name.replace("_", " "), answer[name])
    if "falling" in answer:
        yield "blocks that fall", ", ".join(answer["falling"]), ""
    for name in ("equilibrium_residual", "cone_violation", "mechanism_violation", "duality_gap", "seconds"):
        yield name.replace("_", " "), number(answer[name], 2), ""
    if values["coulomb"]:
        yield from _coulomb_rows(scene, values["coulomb"])


def _coulomb_rows(scene: Scene, answer: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """The Coulomb answer: value, interval, value for sharp arrises, evidence, and what it took."""
    yield "Coulomb: status", answer["status"], ""
    low, high = answer[f"{scene.quantity}_interval"]
    yield _quantity(scene, f"Coulomb: {scene.quantity}", answer[scene.quantity])
    yield _quantity(scene, "Coulomb: least by its mechanism", low)
    yield _quantity(scene, "Coulomb: greatest by its mechanism", high)
    yield _quantity(scene, f"Coulomb: {scene.quantity} sharp", answer[f"{scene.quantity}_sharp"])
    for name in ("dilatancy_residual", "drift", "seconds"):
        yield f"Coulomb: {name.replace('_', ' ')}", number(answer[name], 2), ""
    yield "Coulomb: associated solves", str(answer["iterations"]), ""


def _quantity(scene: Scene, name: str, value: float | None) -> tuple[str, str, str]:
    return name, number(value), "" if scene.live is not None else number(over_weight(value, scene.weight))
