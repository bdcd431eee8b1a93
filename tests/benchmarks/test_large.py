"""Large structures by both methods: they are as large as their page says, and the page shows the recorded values."""

import benchmark_large
import numpy as np
import pytest
from benchmark_large import SCENES, page
from verdict_scenes import drawn

from la_core.model import assemble


def test_the_facade_has_about_1500_blocks_openings_and_a_third_that_settles() -> None:
    scene = SCENES["brick facade"]()
    assert 1450 <= scene.blocks.free.sum() <= 1550 and scene.friction == 0.4
    assembly = assemble(scene)
    assert assembly.support_speed == 1.0 and assembly.effects.plane
    length, height = np.ptp(scene.blocks.vertices[:, 0]), np.ptp(scene.blocks.vertices[:, 2])
    solid = scene.weight / (9.81 * benchmark_large.DENSITY * benchmark_large.BRICK[1])
    assert 0.75 < solid / (length * height) < 0.95  # openings are missing, and the footing


def test_the_sizes_are_those_that_the_scenes_are_named_after() -> None:
    sizes = {name: int(SCENES[name]().blocks.free.sum()) for name in ("10 x 6 wall", "250 blocks", "1,000 blocks")}
    in_space = SCENES["250 blocks in space"]()
    assert not assemble(in_space).effects.plane and int(in_space.blocks.free.sum()) == sizes["250 blocks"]
    assert 60 <= sizes["10 x 6 wall"] <= 66 and abs(sizes["250 blocks"] - 250) <= 5 and abs(sizes["1,000 blocks"] - 1000) <= 20


@pytest.mark.parametrize("number", [0, 4, 8])
def test_the_random_structures_are_longer_and_higher_than_those_of_the_verdicts(number: int) -> None:
    scene, small = SCENES[f"random {number}"](), drawn(number, benchmark_large.RANDOM_SEED).scene
    assert 48 <= scene.blocks.free.sum() <= 200 and scene.title == small.title
    larger = np.ptp(scene.blocks.vertices, axis=0) / np.ptp(small.blocks.vertices, axis=0)
    assert 1.2 < larger[0] < 4.0 and 1.2 < larger[2] < 4.0 and larger[1] == pytest.approx(1.0)


def test_the_page_shows_values_verdicts_and_reasons() -> None:
    entry = {
        "name": "250 blocks", "blocks": 248, "friction": 0.4, "weight": 1e4, "threads": 2, "verdict": "disagree", "reason": "they differ",
        "coulomb_status": "solved", "yade_status": "plateau", "coulomb_seconds": 20.0, "yade_seconds": 120.0, "steps": 1234567,
        "minutes": 2.5, "coulomb": 0.1, "coulomb_uncertainty": 1e-4, "yade": 0.11, "yade_uncertainty": 2e-4,
    }  # fmt: skip
    unfinished = entry | {"name": "1,000 blocks", "verdict": "inconclusive", "yade": None, "yade_status": "timeout"}
    text = page({"versions": {"python": "3"}, "scenes": {"1,000 blocks": unfinished, "250 blocks": entry}})
    assert text.index("| 250 blocks | 248 |") < text.index("| 1,000 blocks | 248 |")
    assert "| 9.1 % | ✗ disagree | 20 | 120 | 1,234,567 | 2.5 |" in text and "| timeout | – | ? inconclusive |" in text
    assert "**250 blocks** is disagree: they differ" in text
    assert "Random irregular structures" not in text
    text = page({"versions": {}, "scenes": {"random 3": entry | {"name": "random 3"}, "250 blocks": entry}})
    assert text.index("| 250 blocks |") < text.index("Random irregular structures") < text.index("| random 3 |")
