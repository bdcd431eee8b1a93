"""Table of effects: on or off, the model and its reason, the savings without the effect and its cost."""

from typing import Any

from la_core.analysis import LimitAnalysis
from la_core.coulomb import PredictionSettings
from la_core.exchange import PLATEAU_SHARE, POSES
from la_core.geometry import contact_points
from la_core.model import PLANE_FREEDOMS, Assembly
from la_core.scene import Scene

PATHS = len(PredictionSettings().viscosities)  # number of paths of a prediction; the search for a sliding joint needs one
BODIES_OF_BLOCK = 3  # clump, carrier and face

EFFECTS: dict[str, tuple[bool | str, ...]] = {  # choices without the effect
    "plane": (True,),
    "friction": ("none-slides", "associated"),
    "elasticity": ("none",),
    "rotation": ("small",),
    "reach": (True,),
    "displacement": ("small",),
    "recording": ("plateau",),
}
WORDS = {  # names of the physical effects
    "plane": "motion out of the plane",
    "friction": "sliding without dilatancy",
    "elasticity": "strain of the joints",
    "rotation": "release of thrusts by turning blocks",
    "reach": "blocks beyond the support's reach",
    "displacement": "contacts that come into being",
    "recording": "states on the way to the plateau",
}


def effects_summary(scene: Scene, whole: Assembly, assembly: Assembly, analysis: LimitAnalysis | None = None) -> dict[str, Any]:
    """Return the choice of each effect, all reasons, and `table` with one row for each effect, in the order of EFFECTS.

    A row has effect, what (its meaning), on, modelled, reason, saved (counts by name if the effect is off) and seconds (measured if the
    effect is on and limit analysis spent time on it alone; else None).

    Parameters
    ----------
    scene : Scene
        The scene of the analysis.
    whole : Assembly
        Assembly of all blocks.
    assembly : Assembly
        Assembly of the modelled blocks.
    analysis : LimitAnalysis or None
        Result of limit analysis; None before the analysis.
    """
    effects = assembly.effects
    saved, seconds = _saved(scene, whole, assembly), _seconds(analysis)
    table = [
        {
            "effect": name,
            "what": WORDS[name],
            "on": (on := getattr(effects, name) not in left_out),
            "modelled": _modelled(name, getattr(effects, name)),
            "reason": effects.reasons.get(name, ""),
            "saved": {} if on else saved.get(name, {}),
            "seconds": seconds.get(name) if on else None,
        }
        for name, left_out in EFFECTS.items()
    ]
    return {name: getattr(effects, name) for name in EFFECTS} | {"reasons": dict(effects.reasons), "table": table}


def _modelled(name: str, choice: bool | str) -> str:
    if isinstance(choice, str):
        return choice
    yes, no = {"plane": ("plane", "in space"), "reach": ("within reach", "all blocks")}[name]
    return yes if choice else no


def _saved(scene: Scene, whole: Assembly, assembly: Assembly) -> dict[str, dict[str, int]]:
    """Return the counts that a model without each effect saves, compared with the same model with the effect."""
    free, points, plane, aside = int(assembly.blocks.free.sum()), len(assembly.points), assembly.effects.plane, int(assembly.aside.sum())
    freedoms, components = (len(PLANE_FREEDOMS), 2) if plane else (6, 3)
    saved = {
        "friction": {"path or more of the prediction": PATHS - 1},
        "elasticity": {"springs": points * components},
        "rotation": {"run of YADE over its whole travel": 1},
        "displacement": {"engine in YADE, the collider": 1},
        "recording": {"states": int(PLATEAU_SHARE * scene.yade.get("poses", POSES))},
    }
    if aside:
        spared = len(whole.points) - points
        saved["reach"] = {
            "unknowns": freedoms * aside,
            "contact points": spared,
            "bodies in YADE": BODIES_OF_BLOCK * aside,
            "spheres in YADE": spared,
        }
    if plane:
        solid = len(contact_points(assembly.blocks, assembly.interfaces, scene.friction, assembly.inset, plane=False))
        saved["plane"] = {
            "unknowns": free * (6 - freedoms),
            "contact points": solid - points,
            "second-order cones": solid,
            "spheres in YADE": solid - points,
        }
    return saved


def _seconds(analysis: LimitAnalysis | None) -> dict[str, float]:
    """Return the solver's seconds for each effect alone, by effect."""
    if analysis is None or analysis.coulomb is None:
        return {}
    solutions = {id(solution): solution for solution in (analysis.coulomb, analysis.sharp.coulomb) if solution is not None}
    seconds = {"friction": sum(solution.seconds for solution in solutions.values())}
    return seconds | ({"elasticity": analysis.path.seconds} if analysis.path is not None else {})
