"""Barrel vaults and domes have plane faces, exact volumes and closed joints, and shapes that cannot be built are refused."""

import math
from typing import Any

import numpy as np
import pytest
import scenes
from measured_shapes import free_volume
from vaults_and_domes import CLOSED, RIGHT, WHOLE, dome, vault

from la_core.errors import SceneError
from la_core.geometry.blocks import Blocks
from la_core.model.assembly import assemble

ROUND_OFF = 1e-12  # of a length, an area or a volume


def face_gaps(blocks: Blocks) -> np.ndarray:
    """Distance (L,) of every corner of every face from the face's plane, m."""
    face = np.repeat(np.arange(len(blocks.face_offset)), np.diff(blocks.face_start))
    return np.sum(blocks.vertices[blocks.face_vertex] * blocks.face_normal[face], axis=1) - blocks.face_offset[face]


def heights_above_faces(blocks: Blocks) -> np.ndarray:
    """Largest distance (B,) of a block's vertices outside any plane of its own faces, m."""
    highest = np.full(len(blocks), -np.inf)
    for face, block in enumerate(blocks.face_block):
        own = blocks.vertices[blocks.vertex_start[block] : blocks.vertex_start[block + 1]]
        highest[block] = max(highest[block], (own @ blocks.face_normal[face]).max() - blocks.face_offset[face])
    return highest


# --- geometry ----------------------------------------------------------------------------------------------------------------


BUILT = {
    "running vault": vault(),
    "stacked vault": vault(bond="stack", embrace=180.0),
    "sector": dome(),
    "free sector": dome(sides="free"),
    "hemisphere": dome(**CLOSED, embrace=90.0),
    "open dome": dome(**WHOLE),
    "closed sector": dome(oculus=0.0),
    "closed half": dome(oculus=0.0, sector=180.0),
    "wide sector": dome(oculus=50.0, sector=240.0),
}

every_shell = pytest.mark.parametrize("name", BUILT)


@every_shell
def test_voussoirs_and_springers_have_plane_faces_and_are_convex(name: str) -> None:
    blocks = scenes.build(BUILT[name], settlement=RIGHT).blocks
    assert (blocks.volume > 0.0).all()
    assert np.abs(face_gaps(blocks)).max() <= ROUND_OFF * 10.0
    assert heights_above_faces(blocks).max() <= ROUND_OFF * 10.0


def test_volume_of_a_vault_is_that_of_its_straight_sided_ring_times_its_length() -> None:
    opening = math.radians(140.0) / 7
    ring = 7 * 0.5 * math.sin(opening) * (2.2**2 - 1.8**2)
    for bond in ("running", "stack"):
        assert free_volume(scenes.build(vault(bond=bond), settlement=RIGHT)) == pytest.approx(3.0 * ring, rel=ROUND_OFF)


def frustum_volume(inner: float, outer: float, lunes: int, above: float, below: float) -> float:
    """Volume of a voussoir: difference of two pyramids about the centre over a trapezoid with corners on the unit sphere."""
    return (outer**3 - inner**3) / 6.0 * math.sin(2.0 * math.pi / lunes) * (math.sin(above) + math.sin(below)) * math.sin(below - above)


def test_volume_of_a_dome_is_that_of_its_frusta() -> None:
    parallels = np.radians(np.linspace(20.0, 80.0, 5))
    lune = sum(frustum_volume(1.8, 2.2, 12, *parallels[k : k + 2]) for k in range(4))
    assert free_volume(scenes.build(dome(), settlement=RIGHT)) == pytest.approx(4 * lune, rel=ROUND_OFF)
    parallels = np.radians(np.linspace(0.0, 80.0, 5))  # now a keystone from 0 to 20 degrees, with flat faces
    keystone = (2.2**3 - 1.8**3) / 6.0 * math.sin(math.pi / 6.0) * math.sin(parallels[1]) ** 2 * math.cos(parallels[1])
    lune = keystone + sum(frustum_volume(1.8, 2.2, 12, *parallels[k : k + 2]) for k in range(1, 4))
    for changes, lunes in ((CLOSED, 12), ({"oculus": 0.0}, 4), ({"oculus": 0.0, "sector": 180.0}, 6)):
        assert free_volume(scenes.build(dome(**changes), settlement=RIGHT)) == pytest.approx(lunes * lune, rel=ROUND_OFF)


SECOND_ORDER = 0.05  # of the factor four by which halving the voussoirs divides the error: terms of the fourth order


def test_volume_of_a_dome_tends_to_that_of_the_shell_at_second_order() -> None:
    shell = 2.0 * math.pi / 3.0 * (2.2**3 - 1.8**3) * (1.0 - math.cos(math.radians(80.0)))
    missing = [
        shell - free_volume(scenes.build(dome(**CLOSED, courses=courses, lunes=3 * courses), settlement=RIGHT)) for courses in (6, 12, 24)
    ]
    assert missing[0] / missing[1] == pytest.approx(4.0, rel=SECOND_ORDER)
    assert missing[1] / missing[2] == pytest.approx(4.0, rel=SECOND_ORDER)


@pytest.mark.parametrize(("bond", "heads"), [("stack", 7 * 2), ("running", 4 * 2 + 3 * 3)])
def test_joints_of_a_vault_are_closed_all_over(bond: str, heads: int) -> None:
    """Eight radial joints over the whole length, and a head joint between every two voussoirs of a course."""
    opening = math.radians(140.0) / 7
    expected = 8 * 0.4 * 3.0 + heads * 0.5 * math.sin(opening) * (2.2**2 - 1.8**2)
    assembly = assemble(scenes.build(vault(bond=bond), settlement=RIGHT))
    assert assembly.interfaces.area.sum() == pytest.approx(expected, rel=ROUND_OFF * 10.0)


def bed_area(lunes: int, phi: float) -> float:
    """Area of a bed joint of the test's dome: difference of two triangles about the centre over a chord of the parallel."""
    half_chord = math.sin(phi) * math.sin(math.pi / lunes)
    return (2.2**2 - 1.8**2) * half_chord * math.sqrt(1.0 - half_chord**2)


@pytest.mark.parametrize(
    ("changes", "lunes", "meridians", "courses"),
    [({}, 4, 5, 4), ({"sides": "free"}, 4, 3, 4), (WHOLE, 12, 12, 4), (CLOSED, 12, 12, 3), ({"sector": 180.0}, 6, 7, 4)],
)
def test_joints_of_a_dome_are_closed_all_over(changes: dict[str, Any], lunes: int, meridians: int, courses: int) -> None:
    """A bed joint lies below every voussoir and every side of the keystone; a piece of meridian lies between two voussoirs of a course."""
    parallels = np.radians(np.linspace(0.0 if changes is CLOSED else 20.0, 80.0, 5))
    beds = lunes * sum(bed_area(12, phi) for phi in parallels[1:])
    joints = meridians * courses * 0.5 * math.sin(parallels[1] - parallels[0]) * (2.2**2 - 1.8**2)
    assembly = assemble(scenes.build(dome(**changes), settlement=RIGHT))
    assert assembly.interfaces.area.sum() == pytest.approx(beds + joints, rel=ROUND_OFF * 10.0)


# --- shapes that cannot be built ---------------------------------------------------------------------------------------------


IMPOSSIBLE = {
    "vault thicker than its circle": (vault(thickness=4.0), 'vault[0]: `thickness` must be less than twice `radius`'),
    "vault of one slab": (vault(voussoirs=1), "vault[0]: a voussoir may span at most 120 degrees; take more `voussoirs`"),
    "vault beyond a semicircle": (vault(embrace=181.0), "vault[0].embrace = 181.0: must be less than or equal to 180"),
    "vault without rings": (vault(rings=0), "vault[0].rings = 0: must be greater than or equal to 1"),
    "vault without a bond": (vault(bond=None), "vault[0].bond: missing"),
    "vault of an unknown bond": (vault(bond="english"), "vault[0].bond = 'english': must be 'running' or 'stack'"),
    "vault of a free springer": (vault(springers={"left": "free", "right": "fixed"}), "vault[0].springers.left = 'free': must be"),
    "vault of too many blocks": (vault(voussoirs=1000, rings=1000), "vault[0]: `voussoirs` times `rings` may be at most 50000"),
    "vault with a depth": (vault(depth=1.0), "vault[0].depth: unknown key"),
    "dome thicker than its sphere": (dome(thickness=4.0), "dome[0]: `thickness` must be less than twice `radius`"),
    "dome that is all oculus": (dome(oculus=80.0), "dome[0]: `oculus` must be less than `embrace`; otherwise the dome has no courses"),
    "dome beyond a hemisphere": (dome(embrace=91.0), "dome[0].embrace = 91.0: must be less than or equal to 90"),
    "dome of a keystone alone": (dome(oculus=0.0, courses=1), "dome[0]: `courses` must be at least 2 where a keystone closes the dome"),
    "dome of two lunes": (dome(lunes=2), "dome[0].lunes = 2: must be greater than or equal to 3"),
    "sector that cuts a lune": (dome(sector=100.0), "dome[0]: `sector` must be a multiple of a lune, which is 30 degrees wide"),
    "sector narrower than a lune": (dome(sector=1e-8), "dome[0]: `sector` must be a multiple of a lune"),
    "keystone that is not convex": (dome(sector=240.0, oculus=0.0), "dome[0]: the keystone of a `sector` between 180 and 360 degrees"),
    "whole dome with sides": (dome(sector=360.0), 'dome[0]: `sides = "fixed"` or `"free"` is needed for a `sector` of less than 360'),
    "sector without sides": (dome(sides=None), 'dome[0]: `sides = "fixed"` or `"free"` is needed for a `sector` of less than 360'),
    "support beyond the sector": (dome(support=(4, 5)), "dome[0]: `support` must be a first and a last lune"),
    "support the wrong way": (dome(support=(3, 2)), "dome[0]: `support` must be a first and a last lune, in this order"),
    "support that is no lune": (dome(support=(0, 2)), "dome[0].support[0] = 0: must be greater than or equal to 1"),
    "dome of too many blocks": (dome(courses=1000, lunes=1200), "dome[0]: `courses` times `lunes` may be at most 50000"),
    "abutments in each other's way": (dome(sector=330.0, oculus=10.0), "overlap by"),
}  # fmt: skip


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_what_cannot_be_built_is_refused_by_name(name: str) -> None:
    part, expected = IMPOSSIBLE[name]
    with pytest.raises(SceneError) as error:
        assemble(scenes.build(part, settlement=RIGHT))
    assert expected in str(error.value)
