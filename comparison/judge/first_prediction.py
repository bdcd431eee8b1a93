"""The first answer of limit analysis, from before YADE's run, if this run showed that the answer lacks a needed effect."""

import json
from typing import Any

from comparison.judge.effects_table import EFFECTS
from comparison.numbers import several_plateaus, with_uncertainty
from la_core.analysis import LimitAnalysis, associated_values, coulomb_values
from la_core.text_table import exists

WITHOUT = {  # phrase for the lack of each effect in the first answer
    "friction": "sliding",
    "plane": "motion out of the plane",
    "reach": "blocks beyond the support's reach",
    "displacement": "new contacts",
}
WHY = {  # reason why the effect was restored
    "friction": "joints slide in YADE, so friction was modelled",
    "plane": "the plane answer does not hold in space, so motion in space was modelled",
    "reach": "blocks that were left out do not rest in YADE, so all blocks were modelled",
    "displacement": "blocks came near to each other in YADE, so new contacts were modelled",
}


def answer_of(analysis: LimitAnalysis) -> dict[str, Any]:
    """Return the answer of an analysis.

    The keys are `left_out` (the effects that the model leaves out), `associated` and `coulomb` (as in `limit_analysis` of
    `comparison.json`; `coulomb` is None without a prediction).
    """
    effects = analysis.assembly.effects
    left_out = [name for name, choices in EFFECTS.items() if getattr(effects, name) in choices]
    return {"left_out": left_out, "associated": associated_values(analysis), "coulomb": coulomb_values(analysis)}


def answer_of_text(text: str) -> dict[str, Any]:
    """Return an answer that was stored as JSON; raises an error of Python for any other text."""
    answer = dict(json.loads(text))
    _value(answer, "")  # this reads all values of the sentence, so that a text without them is not accepted as an answer
    return answer | {"left_out": list(answer["left_out"])}


def first_prediction_summary(first: dict[str, Any] | None, analysis: LimitAnalysis) -> dict[str, Any] | None:
    """Return the first answer with `restored`, the effects restored since, and `sentence`, both answers in words; None without one.

    first: the first answer in the form of `answer_of`, None if no effect was restored. analysis: the analysis with the restored effects.
    """
    if first is None:
        return None
    restored = list(analysis.assembly.effects.called_back)
    without = " and ".join(WITHOUT.get(effect, effect) for effect in restored)
    why = "; ".join(WHY.get(effect, f"{effect} was modelled") for effect in restored)
    before, now = (_value(answer, analysis.scene.unit) for answer in (first, answer_of(analysis)))
    return first | {"restored": restored, "sentence": f"Before YADE ran, limit analysis without {without} said {before}; {why}: {now}."}


def _value(answer: dict[str, Any], unit: str) -> str:
    """Return the value that is compared with YADE, with uncertainty, unit and all plateaus, and with the status unless this is solved."""
    found = answer["coulomb"] or answer["associated"]
    status, shared = str(found.get("status")), found.get("shared_inset", found)
    value = shared.get("reaction", shared.get("multiplier"))
    if not exists(value):
        return status
    remarks = [words] if (words := several_plateaus(shared.get("plateaus"), unit)) else []
    remarks += [] if status == "solved" else [status]
    return f"{with_uncertainty(value, shared.get('uncertainty'))} {unit}".rstrip() + (f" ({'; '.join(remarks)})" if remarks else "")
