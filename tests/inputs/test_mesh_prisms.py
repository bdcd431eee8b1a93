"""Prisms of a profile with dents keep the outline of their ends in mesh files of any format and with any division into triangles."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from mesh_files import binary_ply, obj, ply, reaction, stl, written
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from la_core.geometry import find_interfaces
from la_core.model import assemble
from la_core.scene.generators.mesh_formats import surfaces
from la_core.scene.generators.mesh_surface import shape_of, surface
from la_core.scene.scene import load_scene

Profile = Sequence[tuple[float, float]]
Faces = list[tuple[int, ...]]
# A stone on two legs, with an opening of 0.2 x 0.2 between them: 0.5 - 0.04 in area.
LEGS = ((0.0, 0.0), (0.4, 0.0), (0.4, 0.2), (0.6, 0.2), (0.6, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5))
DEPTH = 0.2
LEGS_VOLUME = (0.5 - 0.04) * DEPTH
PADS = "\n".join(
    f'[[block]]\nname = "{name}"\nrole = "{role}"\nbox = {{ from = [{low}, 0.0, -0.1], to = [{high}, {DEPTH}, 0.0] }}'
    for name, role, low, high in (("left", "fixed", 0.0, 0.4), ("right", "support", 0.6, 1.0))
)


def body(profile: Profile, ends: Sequence[Sequence[int]] | None = None) -> tuple[np.ndarray, Faces]:
    """A prism along y with its profile, counter-clockwise, at y = 0 and at DEPTH. `ends`: faces of the first end, by default one face."""
    n = len(profile)
    vertices = np.array([[x, y, z] for y in (0.0, DEPTH) for x, z in profile])
    front = [tuple(face) for face in ends or [range(n)]]
    back = [tuple(n + corner for corner in face[::-1]) for face in front]
    return vertices, [*front, *back, *((k, n + k, n + (k + 1) % n, (k + 1) % n) for k in range(n))]


def in_triangles(faces: Faces) -> Faces:
    """The faces, with each face of four corners (a side) divided into two triangles."""
    return [triangle for face in faces for triangle in ([face] if len(face) == 3 else [face[:3], (face[0], *face[2:])])]


def on_pads(folder: Path, file: str, content: str | bytes) -> Path:
    path = written(folder, file, content, fixed=[], support=[])
    path.write_text(f"{path.read_text()}\n{PADS}\n")
    return path


def volume(vertices: np.ndarray, faces: Faces) -> float:
    shape = shape_of(surface("body", vertices, faces))[0]
    return float(sum(ConvexHull(part.vertices).volume for part in shape.parts))


@pytest.mark.parametrize("first", range(len(LEGS)))
@pytest.mark.parametrize("indices", ["vertex_indices", "vertex_index"])
def test_faces_of_a_ply_keep_their_outline(indices: str, first: int, tmp_path: Path) -> None:
    """The right leg settles, and the stone turns about the inner edge of the left leg. For the weight W at x = 0.5, R (1 - 0.4) =
    W (0.5 - 0.4). Triangles about the first corner of an end lay in the opening, and gave 0.169 W."""
    vertices, faces = body(LEGS[first:] + LEGS[:first])
    scene = load_scene(on_pads(tmp_path, "legs.ply", ply(vertices, faces, indices)))
    assert scene.blocks.volume[scene.blocks.names.index("legs")] == pytest.approx(LEGS_VOLUME)
    assert len(find_interfaces(scene.blocks)) == 2
    assert reaction(scene) == pytest.approx(0.1 / 0.6, abs=1e-6)


@pytest.mark.parametrize("write", [ply, lambda vertices, faces: obj({"legs": vertices}, faces)], ids=["PLY", "OBJ"])
def test_two_faces_may_share_three_corners_of_a_line(write: Callable[[np.ndarray, Faces], str]) -> None:
    """Each upper edge has a corner in its middle. The triangles about the preceding corner used one edge four times."""
    profile = (*LEGS[:7], (0.5, 0.5), LEGS[7])
    vertices, faces = body(profile[6:] + profile[:6])  # (1, 0.5), (0.5, 0.5), (0, 0.5) come first
    n = len(profile)
    faces = [face for face in faces if face not in ((0, n, n + 1, 1), (1, n + 1, n + 2, 2))] + [(0, n, n + 1, n + 2, 2, 1)]
    suffix = ".ply" if write is ply else ".obj"
    read = surfaces(suffix, write(vertices, faces).encode(), "legs")[0]
    assert volume(read.vertices, list(read.faces)) == pytest.approx(LEGS_VOLUME)


def test_a_body_with_dents_in_plan_is_not_plane(tmp_path: Path) -> None:
    """The legs point along y. The body spans the depth, but its parts do not: as a plane structure it could not turn about x."""
    vertices, faces = body(LEGS)
    on_plan = vertices[:, [0, 2, 1]] * [1.0, DEPTH / 0.5, 1.0]
    scene = load_scene(on_pads(tmp_path, "legs.ply", ply(on_plan, [face[::-1] for face in faces])))
    assembly = assemble(scene)
    assert not assembly.effects.plane
    assert assembly.effects.reasons["plane"].startswith('block "legs" does not span the whole depth')


def test_triangles_of_a_binary_ply_are_read() -> None:
    triangles = [(0, 1, 2), (0, 2, 7), (2, 6, 7), (2, 3, 6), (3, 5, 6), (3, 4, 5)]
    vertices, faces = body(LEGS, triangles)
    faces = in_triangles(faces)
    read = surfaces(".ply", binary_ply(vertices, faces), "legs")[0]
    assert len(read.faces) == len(faces)
    assert volume(read.vertices, list(read.faces)) == pytest.approx(LEGS_VOLUME)


@pytest.mark.parametrize("order", ["big", "little"])
@pytest.mark.parametrize("colour", [False, True])
def test_faces_of_a_binary_ply_have_any_numbers_of_corners(order: str, colour: bool) -> None:
    """3D drawing programs write a prism with ends of eight corners and sides of four. Such a file was refused as not whole."""
    vertices, faces = body(LEGS)
    read = surfaces(".ply", binary_ply(vertices, faces, order=order, colour=colour), "legs")[0]
    assert read.faces == tuple(faces)
    assert read.vertices.tolist() == vertices.tolist()


@pytest.mark.parametrize("change", [lambda whole: whole[:-1], lambda whole: whole[:-40], lambda whole: whole + b"\0"])
def test_a_binary_ply_of_another_length_is_refused(change: Callable[[bytes], bytes]) -> None:
    with pytest.raises(ValueError, match=r"not a whole PLY file: it (is cut off|has more bytes)"):
        surfaces(".ply", change(binary_ply(*body(LEGS))), "legs")


def test_a_ply_may_begin_with_a_comment() -> None:
    vertices, faces = body(LEGS)
    text = ply(vertices, faces).replace("ply\n", "ply\ncomment of a survey\n", 1)
    assert surfaces(".ply", text.encode(), "legs")[0].faces == tuple(faces)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("segments", [6, 10, 20, 30])
def test_a_triangulated_stone_over_a_curved_opening_is_read_at_every_angle(segments: int) -> None:
    """The union of the triangles kept holes, or lost corners, at every second angle."""
    low, high, length, rise = 0.289, 0.83, 1.13, 0.471
    angle = np.linspace(np.pi, 0.0, segments + 1)[1:-1]
    middle, radius = 0.5 * (low + high), 0.5 * (high - low)
    arc = [(middle + radius * np.cos(a), 0.9 * radius * np.sin(a)) for a in angle]
    profile = [(0.0, 0.0), (low, 0.0), *arc, (high, 0.0), (length, 0.0), (length, rise), (0.0, rise)]
    n, crown = len(profile), 1 + segments // 2
    left, right = n - 1, n - 2  # the upper corners see a half of the opening each
    ends = [(left, k, k + 1) for k in range(crown)] + [(left, crown, right)] + [(right, k, k + 1) for k in range(crown, n - 3)]
    vertices, faces = body(profile, ends)
    # The opening has its triangles about the middle of its springing.
    opening = 0.5 * 0.9 * radius**2 * segments * np.sin(np.pi / segments)
    for degrees in np.random.default_rng(0).uniform(-180.0, 180.0, 25):
        turned = vertices @ Rotation.from_euler("z", degrees, degrees=True).as_matrix().T
        assert volume(turned, in_triangles(faces)) == pytest.approx((length * rise - opening) * DEPTH, rel=1e-9)


def test_triangles_without_area_in_the_ends_of_a_stone_change_nothing() -> None:
    """The upper edge has a corner in its middle. A triangle without area joins this corner to the ends of the edge."""
    profile = (*LEGS[:7], (0.5, 0.5), LEGS[7])
    vertices, faces = body(profile, [(0, 1, 2), (0, 2, 8), (2, 6, 8), (2, 3, 6), (3, 5, 6), (3, 4, 5), (6, 7, 8)])
    assert volume(vertices, in_triangles(faces)) == pytest.approx(LEGS_VOLUME)


def test_triangles_that_lie_outside_of_a_face_with_dents_keep_its_outline() -> None:
    """Some programs write STL files in which every face is divided about its first corner."""
    n = len(LEGS)
    vertices, faces = body(LEGS, [(0, k, k + 1) for k in range(1, n - 1)])
    read = surfaces(".stl", stl(vertices, in_triangles(faces)), "legs")[0]
    assert volume(read.vertices, list(read.faces)) == pytest.approx(LEGS_VOLUME)


@pytest.mark.parametrize("seed", range(5))
def test_corners_of_a_straight_edge_may_be_bent_inwards_by_single_precision(seed: int) -> None:
    """The bed of a quoin has corners at its thirds, 30 m from the origin. No cut was found from a corner with so slight a bend."""
    profile = [(0.0, 0.0), (1.0 / 3.0, 0.0), (2.0 / 3.0, 0.0), (1.0, 0.0), (1.0, 0.4), (0.3, 0.4), (0.3, 1.0), (0.0, 1.0), (0.0, 0.5)]
    vertices, faces = body(profile)
    turned = vertices @ Rotation.random(random_state=seed).as_matrix().T + 30.0
    single = turned.astype(np.float32).astype(float)
    assert volume(single, faces) == pytest.approx(0.58 * DEPTH, rel=1e-4)


def test_an_end_with_a_corner_beside_its_plane_is_refused() -> None:
    """A corner on the left edge lies 10 mm behind the plane of the end. The triangles about the first corner hide it."""
    profile = (*LEGS, (0.0, 0.2))
    vertices, faces = body(profile)
    vertices[len(LEGS), 1] = 0.01
    with pytest.raises(ValueError, match="is not convex: its deepest dent"):
        volume(vertices, faces)


def test_a_body_whose_sides_fill_a_part_of_its_dent_is_no_prism() -> None:
    """A cube has a rebate of 0.1 x 0.1 along an edge. Sides across a diagonal fill a sixth of the rebate, under a hundredth of the cube."""
    profile = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.9), (0.9, 0.9), (0.9, 1.0), (0.0, 1.0))
    vertices, faces = body(profile)
    vertices = vertices * [1.0, 1.0 / DEPTH, 1.0]
    assert volume(vertices, faces) == pytest.approx(0.99)
    sides = {(2, 8, 9, 3), (3, 9, 10, 4)}
    filled = [face for face in faces if face not in sides] + [(2, 10, 3), (3, 10, 4), (2, 9, 10), (2, 8, 9)]
    with pytest.raises(ValueError, match="is not convex: its deepest dent"):
        volume(vertices, filled)


@pytest.mark.parametrize("extra", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_a_surveyed_prism_with_dents_is_read(seed: int, extra: bool) -> None:
    """Every coordinate is off by up to 0.6 of the tolerance. The plane of one triangle missed other corners of its end, and the stone was
    refused as a body that is no prism. Corners within an edge have the same errors and add nothing to the outline."""
    tolerance, random = 0.005, np.random.default_rng(seed)
    profile = [(0.0, 0.0), (0.2, 0.0), *LEGS[1:6], (1.0, 0.25), *LEGS[6:]] if extra else LEGS
    vertices, faces = body(profile)
    turned = vertices @ Rotation.random(random_state=seed).as_matrix().T + random.uniform(-0.6, 0.6, vertices.shape) * tolerance
    shape = shape_of(surface("legs", turned, faces), tolerance)[0]
    assert len(shape.parts) == 3
    assert sum(ConvexHull(part.vertices).volume for part in shape.parts) == pytest.approx(LEGS_VOLUME, rel=0.03)
    near = np.linalg.norm(shape.vertices[:, None] - turned, axis=2)
    assert near.min(axis=0)[[profile.index(corner) for corner in LEGS]].max() < 2.0 * tolerance


def test_an_exact_curve_of_a_prism_with_dents_keeps_its_corners_within_a_tolerance() -> None:
    angle = np.linspace(np.pi, 0.0, 31)
    arc = [(0.5 + 0.3 * np.cos(a), 0.3 * np.sin(a)) for a in angle]
    vertices, faces = body([(0.0, 0.0), *arc, (1.0, 0.0), (1.0, 0.5), (0.0, 0.5)])
    exact, within = (shape_of(surface("soffit", vertices, faces), tolerance)[0] for tolerance in (0.0, 0.01))
    assert np.array_equal(exact.vertices, within.vertices)
