"""Scenes whose turning blocks release a thrust, and YADE's reactions after its whole travel."""

import pytest
from verdict_scenes import FRESH_SEED, SEED, drawn

SMALL, FINITE = ({"effects.rotation": rotation} for rotation in ("small", "finite"))
RELEASES = drawn(0, FRESH_SEED).scene  # YADE has 0.0808 W over the first tenth of a millimetre, and 0.0660 W after its whole travel
# Number, seed and YADE's reaction over the weight, measured on joints 16 or 64 times as stiff as those of limit analysis.
OF_YADE = [
    pytest.param(0, FRESH_SEED, 0.0660, id="wall"),
    pytest.param(10, SEED, 0.2209, id="support that turns"),
    pytest.param(94, SEED, 0.1856, id="reaction that rises"),
    pytest.param(69, FRESH_SEED, 0.0348, id="release between 8 and 32 travels"),
]
