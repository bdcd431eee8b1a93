"""A contact at an edge is no joint. The proof of a fall holds for the joints of the model only, and the next step says so."""

import pytest
import scenes

from comparison.judge.summary import conclusion_of
from comparison.verdict import Verdict
from la_core.analysis.stage import analyse


@pytest.mark.parametrize(("blunt", "stands"), [(0.0, False), (0.002, True)])
def test_a_plank_that_leans_by_its_edge_has_no_joint_there_and_stands_with_a_narrow_face(blunt: float, stands: bool) -> None:
    """By hand, with sharp edges: moments about the foot's right edge need 0.13 W at the plank's top. Friction at the foot can bear this."""
    narrow = [[1.0, 1.5 - blunt]] if blunt else []
    profile = [[0.2, 0.0], [0.4, 0.0], *narrow, [1.0, 1.5], [0.8, 1.5]]
    held = (
        scenes.box("ground", (0.0, 0.0, -0.1), (0.3, 0.2, 0.0), "fixed"),
        scenes.box("pad", (0.3, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
        scenes.box("wall", (1.0, 0.0, -0.1), (1.2, 0.2, 2.0), "fixed"),
    )
    plank = scenes.block("plank", prism=(profile, (0.0, 0.2)))
    found = conclusion_of(analyse(scenes.build(*held, plank)), [], None)
    assert (found.verdict is not Verdict.CANNOT_STAND) == stands
    assert stands or "at an edge" in found.next_step
