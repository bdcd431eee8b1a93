"""What each method's answer is worth and what it took, and how each method's mechanism measures."""

from collections.abc import Iterable, Iterator
from typing import Any

from comparison.report_numbers import DASH, exists, number

METHODS = {"associated": "limit analysis, associated", "coulomb": "limit analysis, Coulomb", "yade": "YADE"}


def costs(comparison: dict[str, Any], results: dict[str, Any], evidence: Iterable[str]) -> Iterator[dict[str, str]]:
    """How accurate each method's answer is and what it took; `evidence` names the residuals of the associated answer."""
    answers = comparison.get("limit_analysis") or {}
    associated, coulomb, path, yade = (
        part or {} for part in (*map(answers.get, ("associated", "coulomb", "path")), comparison.get("yade"))
    )
    unit = f" {results['unit']}".rstrip()
    quantity = "multiplier" if results["live"] else "reaction"

    def row(method: str, answer: Any, status: str, accuracy: str, work: str, seconds: Any) -> dict[str, str]:
        shown = f"{number(answer, 5)}{unit}" if exists(answer) else status
        return {"method": method, "answer": shown, "accuracy": accuracy, "work": work, "seconds": number(seconds, 2)}

    residuals = [associated[name] for name in evidence if exists(associated.get(name))]
    accuracy = f"largest residual {number(max(residuals), 2)}" if residuals else DASH
    answer = results["multiplier"] if results["live"] else results["least"]
    work = f"{number(associated.get('iterations'))} iterations"
    yield row(METHODS["associated"], answer, results["status"], accuracy, work, associated.get("seconds"))
    if coulomb:
        accuracy = f"dilatancy residual {number(coulomb.get('dilatancy_residual'), 2)}; interval {results['interval']}{unit}"
        work = f"{number(coulomb.get('iterations'))} associated programmes"
        yield row(METHODS["coulomb"], results["coulomb"], results["coulomb_status"], accuracy, work, coulomb.get("seconds"))
    if path:
        values, solves = path.get(quantity) or [], path.get("solves") or []
        accuracy = f"largest strain residual {number(max(path.get('strain_residual') or [0.0]), 2)}"
        work = f"{len(values) - 1} increments, {sum(solves)} associated programmes"
        yield row("limit analysis, path", values[-1] if values else None, DASH, accuracy, work, path.get("seconds"))
    if yade:
        share = results["ratios"]["uncertainty"]
        accuracy = f"± {number(results['uncertainty'], 2)}{unit}, {number(share, 2)} {results['ratio_unit']}" if exists(share) else DASH
        yield row(
            METHODS["yade"], results["yade"], results["yade_status"], accuracy, f"{number(yade.get('steps'))} steps", yade.get("seconds")
        )


def measures(comparison: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Measures of each method's mechanism that is known; power per unit motion of the support is a force."""
    for method, found in (comparison.get("mechanism_measures") or {}).items():
        if exists(found.get("moving_mass_share")):
            yield {"method": METHODS.get(method, method), **found}
