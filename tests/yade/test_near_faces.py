"""Faces near a sphere: while no gap to them is used up, no sphere touches a face that the case does not list."""

import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenes
from counted_rows import Counted
from displaced_blocks import GAP, buffer, with_effects
from verdict_scenes import EARLIER_SEED, drawn

from comparison.yade import ROOT, find_yade
from comparison.yade.installation import yade_environment
from la_core import exchange
from la_core.analysis import case_file
from la_core.analysis.modelling import structural_model
from la_core.analysis.stage import analyse
from la_core.scene import Scene
from yade_scripts import case, settings
from yade_scripts.contacts.near_faces import _SAME_FACE, LEFT, NEAR, NearFaces

LINEAR = 1.1  # most growth of the looks, over that of the wall
CORNER = [[0.0, 0.0], [0.8, 0.0], [0.8, 0.3], [0.3, 0.3], [0.3, 0.8], [0.0, 0.8]]


def compound() -> Scene:
    """A block with a re-entrant corner, and a second block in this corner with a gap to the upright face."""
    parts = (
        scenes.box("fixed base", (0.0, 0.0, -0.2), (0.4, 0.2, 0.0), "fixed"),
        scenes.box("settling base", (0.4, 0.0, -0.2), (0.8, 0.2, 0.0), "support"),
        scenes.block("corner", prism=(CORNER, [0.0, 0.2])),
        scenes.box("in it", (0.3002, 0.0, 0.3), (0.7, 0.2, 0.6)),
    )
    return scenes.build(*parts, inset=0.001)


SCENES: dict[str, Callable[[], Scene]] = {
    "wall": lambda: scenes.build(*scenes.wall(4, 3, split=0.8), inset=0.001),
    "wall with a coarse inset": lambda: scenes.build(*scenes.wall(4, 3, split=0.8), inset=0.012),
    "leaning wall": lambda: drawn(1, EARLIER_SEED).scene,
    "two leaves": lambda: drawn(4, EARLIER_SEED).scene,
    "a block near a stop": lambda: with_effects(buffer()),
    "compound": compound,
}


@pytest.fixture(scope="module", params=SCENES)
def one(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> case.Case:
    """The case of a scene, with finite displacements."""
    return case_of(SCENES[request.param](), tmp_path_factory.mktemp("near") / "case.h5")


def case_of(scene: Scene, path: Path) -> case.Case:
    case_file.write_case(
        path, analyse(structural_model(replace(scene, effects=scene.effects.model_copy(update={"displacement": "finite"})))), ""
    )
    fields = (*exchange.CASE_FIELDS, *exchange.present(path, (*exchange.PART_FIELDS, exchange.JOINT_INSET, exchange.SWAY)))
    return case.from_fields(exchange.read(path, fields))


def beyond(one: case.Case, chosen: settings.Settings, displacement: np.ndarray, rotation: np.ndarray) -> float:
    """Least distance (m) from a sphere of a moved block to a convex part that is not its partner, by the part's farthest face plane."""
    radius = chosen.sphere_radius * one.own_inset / one.inset
    inward = np.where((one.host == one.block_b)[:, None], one.normal, -one.normal)
    turns = [scenes.rotation(tuple(vector), float(np.linalg.norm(vector))) if vector.any() else np.eye(3) for vector in rotation]
    centre = np.array([
        one.centroid[host] + displacement[host] + turns[host] @ (point + size * into - one.centroid[host])
        for host, point, size, into in zip(one.host, one.position, radius, inward, strict=True)
    ])  # fmt: skip
    least = np.inf
    for block, parts in enumerate(one.faces):
        back = (centre - one.centroid[block] - displacement[block]) @ turns[block] + one.centroid[block]
        met = (one.host != block) & (one.target != block) & ((one.role[one.host] == exchange.FREE) | (one.role[block] == exchange.FREE))
        for faces in parts:
            outside = (back @ faces[:, :3].T - faces[:, 3]).max(axis=1) - radius
            least = min(least, float(outside[met].min(initial=np.inf)))
    return least


def plain_pairs(one: case.Case, chosen: settings.Settings) -> list[tuple[int, int]]:
    """Pairs of a sphere and the block of a part near it, part after part, by a look at every sphere."""
    radius = chosen.sphere_radius * one.own_inset / one.inset
    centre = one.position + radius[:, None] * np.where((one.host == one.block_b)[:, None], one.normal, -one.normal)
    reach, found = NEAR * chosen.max_travel * one.support_speed + radius, []
    for block, parts in enumerate(one.parts):
        for vertices, faces in zip(parts, one.faces[block], strict=True):
            for sphere, host in enumerate(one.host.tolist()):
                low, high = vertices.min(axis=0) - reach[sphere], vertices.max(axis=0) + reach[sphere]
                inside = np.all((low < centre[sphere]) & (centre[sphere] < high))
                gaps = faces[:, :3] @ centre[sphere] - faces[:, 3] - radius[sphere]
                is_free = exchange.FREE in (one.role[host], one.role[block])
                is_other = one.target[sphere] != block or gaps.max() > _SAME_FACE * radius[sphere]
                if inside and host != block and is_free and is_other:
                    found.append((sphere, block))
    return found


def test_the_spheres_near_a_part_are_those_that_a_look_at_each_one_finds(one: case.Case) -> None:
    chosen = settings.derive(one)
    near, into_host = NearFaces(one, chosen), np.where((one.host == one.block_b)[:, None], one.normal, -one.normal)
    assert list(zip(near.sphere.tolist(), near.block.tolist(), strict=True)) == plain_pairs(one, chosen)
    edges = [
        (point, *plane[:3])
        for block, parts in enumerate(one.faces)
        if one.boxes[block] is None and len(parts) == 1
        for point in np.flatnonzero(one.target == block).tolist()
        for plane in parts[0].tolist()
        if plane[:3] @ into_host[point] < 1.0 - 1e-6 and not (one.plane and abs(plane[1]) > 0.5)
    ]
    listed = zip(near.on_face.tolist(), near.edge[:, :3].tolist(), strict=True)
    assert [(point, *normal) for point, normal in listed] == edges


def test_a_wall_four_times_as_long_takes_four_times_the_looks_at_spheres(tmp_path: Path) -> None:
    looks = []
    for per_course in (6, 24):
        found = case_of(scenes.build(*scenes.wall(per_course, 3, split=0.4 * per_course - 0.8), inset=0.001), tmp_path / "case.h5")
        counted, Counted.read = replace(found, role=Counted.of(found.role)), 0
        NearFaces(counted, settings.derive(found))
        looks.append(Counted.read)
    assert looks[1] < LINEAR * 4.0 * looks[0]


@pytest.mark.parametrize("apart", [0.0, 0.1, 0.5, 2.0])
def test_while_no_gap_is_used_up_no_sphere_touches_another_face(one: case.Case, apart: float) -> None:
    """The structure turns and shifts as one, by up to half an inset. Each block moves by up to `apart` insets in addition."""
    chosen = settings.derive(one)
    near, chance, arm = NearFaces(one, chosen), np.random.default_rng(1), one.centroid - one.centroid.mean(axis=0)
    quiet = []
    for _ in range(30):
        shift, turn = (0.25 * one.inset * chance.uniform(-1.0, 1.0, 3) for _ in range(2))
        turn /= np.linalg.norm(arm, axis=1).max()
        displacement = shift + np.cross(turn, arm) + apart * one.inset * chance.uniform(-1.0, 1.0, arm.shape)
        rotation = turn + apart * one.inset * chance.uniform(-1.0, 1.0, arm.shape)
        if one.plane:
            displacement[:, 1], rotation[:, [0, 2]] = 0.0, 0.0
        quiet.append(not near.are_met(displacement, rotation))
        assert not quiet[-1] or beyond(one, chosen, displacement, rotation) > 0.0
    assert any(quiet) or apart > 0.1


def test_a_gap_is_used_up_by_a_motion_towards_the_face_and_by_no_other(one: case.Case) -> None:
    near = NearFaces(one, settings.derive(one))
    assert len(near.gap) and near.gap.min() > 0.0
    least = int(near.gap.argmin())
    still, way = np.zeros((len(one.role), 3)), near.gap[least] * near.normal[least]
    for share, met in ((-(1.0 - LEFT) * 1.01, True), (-(1.0 - LEFT) * 0.5, False)):
        moved = still.copy()
        moved[one.host[near.sphere[least]]] = share * way
        assert near.are_met(moved, still) == met
    assert not near.are_met(still, still)


def test_a_block_that_goes_far_may_meet_what_was_not_near(one: case.Case) -> None:
    chosen = settings.derive(one)
    still = np.zeros((len(one.role), 3))
    limit = 0.5 * NEAR * chosen.max_travel * one.support_speed
    far = still + np.array([0.0, 0.0, limit])  # all together: no gap changes
    near = NearFaces(one, chosen)
    assert near.are_met(1.01 * far, still) and not near.are_met(0.99 * far, still)


def test_a_contact_point_at_the_edge_of_a_slanted_face_ends_an_attempt(tmp_path: Path) -> None:
    """YADE models the face as the top of a wider box, which would carry the sphere beyond the edge, too."""
    case_file.write_case(tmp_path / "case.h5", analyse(drawn(11, EARLIER_SEED).scene), "")
    found = case.from_fields(exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY)))
    near, still = NearFaces(found, settings.derive(found)), np.zeros((len(found.role), 3))
    least = int(near.edge[:, 3].argmin())
    point = near.on_face[least]
    assert 0.9 * found.inset < near.edge[least, 3] < 2.0 * found.inset
    along = np.cross(found.normal[point], [0.0, 1.0, 0.0])
    way = along * np.sign(along @ near.edge[least, :3])
    for share, met in ((0.5, False), (1.0, True)):
        moved = still.copy()
        moved[found.host[point]] = share * near.edge[least, 3] / (way @ near.edge[least, :3]) * way
        only = NearFaces(found, settings.derive(found))
        only.gap, only.on_face, only.edge = np.full_like(only.gap, 1.0), near.on_face[[least]], near.edge[[least]]
        assert only.are_met(moved, still) == met


def test_two_held_blocks_never_meet(one: case.Case) -> None:
    held = replace(one, role=np.full(len(one.role), 1))
    near = NearFaces(held, settings.derive(one))
    assert not len(near.gap) and not near.are_met(np.zeros((len(one.role), 3)), np.zeros((len(one.role), 3)))


def test_the_stop_is_among_the_faces_near_the_block(tmp_path: Path) -> None:
    case_file.write_case(tmp_path / "case.h5", analyse(with_effects(buffer())), "")
    found = case.from_fields(exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY)))
    chosen = settings.derive(found)
    near = NearFaces(found, chosen)
    stop = near.block == found.role.tolist().index(exchange.FIXED)
    assert near.gap[stop].min() == pytest.approx(GAP + found.inset - chosen.sphere_radius, rel=1e-6)


@pytest.mark.slow
@pytest.mark.yade
def test_attempts_look_for_new_contacts_from_the_first_one_on_that_meets_a_face(tmp_path: Path) -> None:
    """In a made-up run in YADE's interpreter the second attempt meets a face."""
    case_file.write_case(tmp_path / "case.h5", analyse(with_effects(buffer())), "")
    yade = find_yade()
    statement = f"""
import dataclasses, sys
from pathlib import Path
from types import SimpleNamespace
sys.path[:0] = [{str(ROOT)!r}, {str(yade.modules)!r}]
from la_core import exchange
from yade_scripts import attempts, case, run_case, settings
path = Path({str(tmp_path / "case.h5")!r})
one = case.from_fields(exchange.read(path, run_case.case_fields(path)))
chosen, made = settings.derive(one), []
def run(one, chosen, pace, near):
    made.append((one.displacement, near is not None, chosen.settling_step))
    return SimpleNamespace(met_face=len(made) == 2, steps=10 * len(made), dropped_steps=0, message="m")
attempt = attempts.WithoutSearch(run)
results = [attempt(one, chosen, 1.0) for _ in range(3)]
quick, careful = chosen.settling_step, chosen.time_step
assert quick > careful
assert made == [("small", True, quick), ("small", True, quick), ("finite", False, careful), ("finite", False, careful)]
assert [(one.steps, one.dropped_steps) for one in results] == [(10, 0), (30, 20), (40, 0)]
assert [one.message for one in results] == ["m", "m; YADE looked for new contacts", "m; YADE looked for new contacts"]
assert attempt(dataclasses.replace(one, displacement="small"), chosen, 1.0).message == "m" and made[-1] == ("small", False, quick)
print("as told")
"""
    ended = subprocess.run([yade.python, "-s", "-c", statement], env=yade_environment(), capture_output=True, text=True, check=False)
    assert ended.stdout.splitlines()[-1:] == ["as told"], ended.stderr
