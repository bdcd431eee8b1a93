"""A bad scene is refused with a message that names the file, the block or key, the value where there is one, and the rule."""

from collections.abc import Callable
from pathlib import Path

import pytest
import scenes

from la_core.errors import SceneError
from la_core.model.assembly import assemble
from la_core.scene.scene import load_scene

WriteScene = Callable[[str], Path]

SHAPE = "box     = { from = [0.0, 0.0, 0.0], to = [1.0, 0.2, 0.5] }"
MOTION = "[settlement]\ndirection = [0.0, 0.0, -1.0]"
LIVE = "[live]\ndirection = [1.0, 0.0, 0.0]"
WALL = '[[wall]]\nbond = "running"\norigin = [5.0, 0.0, 0.0]\nblock = [0.4, 0.2, 0.2]\nper_course = 4\ncourses = 4\n'


def refusal(path: Path) -> str:
    with pytest.raises(SceneError) as error:
        assemble(load_scene(path))
    message = str(error.value)
    assert message.startswith(str(path))
    assert all(line.startswith("  ") for line in message.splitlines()[1:]) and "pydantic" not in message and "constrained" not in message
    return message


def swapped(text: str, *swaps: tuple[str, str]) -> str:
    for old, new in swaps:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return text


def prism(profile: str, y: str = "[0.0, 0.2]") -> str:
    return f"prism = {{ profile = {profile}, y = {y} }}"


# Changes of the contract's example, and words of the message: place, value, rule, next step.
CHANGED = {
    "unknown key of a table": (("friction = 0.6", "friction = 0.6\nfricton = 0.6"), 'joint.fricton: unknown key; did you mean "friction"?'),
    "misspelt required key": (("friction = 0.6", "fricton = 0.6"), 'joint.fricton: unknown key; did you mean "friction"?'),
    "unknown key of a block": (("density = 2200.0", "densty = 2200.0"), 'block "block".densty: unknown key; did you mean "density"?'),
    "unknown key of a shape": (("to = [1.0, 0.2, 0.5]", "too = [1.0, 0.2, 0.5]"), 'block "block".box.too: unknown key; did you mean "to"?'),
    "unknown key like no other": (
        ("direction = [0.0", "qqq = 1.0\ndirection = [0.0"),
        "settlement.qqq: unknown key; valid keys: direction, axis, point",
    ),
    "unknown table": (("[joint]", "[joints]"), 'joints: unknown key; did you mean "joint"?'),
    "no friction": (("friction = 0.6", ""), "joint.friction: missing"),
    "no joint": (("[joint]\nfriction = 0.6", ""), "joint: missing"),
    "no density": (
        ("[stone]\ndensity = 2000.0", "", "density = 2200.0", ""),
        'block "block": density: missing; give it one, or give all blocks one by [stone] density',
    ),
    "no name": (('name    = "block"', ""), "block[2].name: missing"),
    "negative density": (("2200.0", "-2200.0"), 'block "block".density = -2200.0: must be greater than 0'),
    "zero density": (("2200.0", "0.0"), 'block "block".density = 0.0: must be greater than 0'),
    "negative friction": (("= 0.6", "= -0.6"), "joint.friction = -0.6: must be greater than or equal to 0"),
    "negative inset": (("= 0.6", "= 0.6\ninset = -0.001"), "joint.inset = -0.001: must be greater than or equal to 0"),
    "nan": (("= 0.6", "= nan"), "joint.friction = nan: must be a finite number"),
    "infinite density": (("2200.0", "inf"), 'block "block".density = inf: must be a finite number'),
    "infinite coordinate": (("0.2, 0.5]", "0.2, -inf]"), 'block "block".box.to[2] = -inf: must be a finite number'),
    "flat box": (("0.2, 0.5]", "0.2, 0.0]"), 'block "block".box: every coordinate of `to` must be greater'),
    "inverted box": (("0.2, 0.5]", "0.2, -0.5]"), 'block "block".box: every coordinate of `to` must be greater'),
    "prism without depth": ((SHAPE, prism("[[0, 0], [1, 0], [1, 1]]", "[0.2, 0.2]")), 'block "block".prism: `y` must rise'),
    "prism on a line": ((SHAPE, prism("[[0.0, 0.0], [1.0, 0.0], [0.5, 0.0]]")), 'block "block": the profile has no area'),
    "prism of two points": (
        (SHAPE, prism("[[0.0, 0.0], [1.0, 0.0]]")),
        'block "block".prism.profile = [[0.0, 0.0], [1.0, 0.0]]: has too few entries, 2 where at least 3 belong',
    ),
    "prism that crosses itself": ((SHAPE, prism("[[0.0, 0.0], [1.0, 0.5], [1.0, 0.0], [0.0, 0.5]]")), 'block "block": the profile crosses'),
    "prism wound twice": (
        (SHAPE, prism("[[0, 0], [1, 0.1], [1.2, 1], [0.5, 1.5], [-0.2, 1], [0.1, 0.05], [0.9, 0], [1.1, 1], [0.5, 1.4]]")),
        'block "block": the profile crosses itself',
    ),
    "flat polyhedron": (
        (SHAPE, "polyhedron = { vertices = [[0, 0, 0], [1, 0, 0], [1, 0.2, 0], [0, 0.2, 0]] }"),
        'block "block": the polyhedron has no volume',
    ),
    "polyhedron of one point": (
        (SHAPE, "polyhedron = { vertices = [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]] }"),
        'block "block": the polyhedron has no volume',
    ),
    "two shapes": (
        (SHAPE, SHAPE + "\n" + prism("[[0, 0], [1, 0], [1, 1]]")),
        'block "block": needs exactly one shape: box, prism or polyhedron; it has `box` and `prism`',
    ),
    "no shape": ((SHAPE, ""), 'block "block": needs exactly one shape: box, prism or polyhedron; it has none'),
    "overlap": (("from = [0.0, 0.0, 0.0], to = [1.0", "from = [0.0, 0.0, -0.05], to = [1.0"), 'blocks "fixed pad" and "block": overlap by'),
    "floating": (
        ("from = [0.0, 0.0, 0.0], to = [1.0", "from = [0.0, 0.0, 0.012], to = [1.0"),
        '"block": touch nothing: no face lies on another block\'s face; "fixed pad" is nearest to "block", about 0.012 m away',
    ),
    "inset too large": (
        ("= 0.6", "= 0.6\ninset = 0.3"),
        'joint.inset = 0.3: larger than half the interface between "fixed pad" and "block"',
    ),
    "inset too large across a plane structure": (
        ("= 0.6", "= 0.6\ninset = 0.15"),
        'joint.inset = 0.15: larger than half the interface between "fixed pad" and "block", and half of all joints are no longer than '
        "that one; take less than 0.1 m",
    ),
    "name given twice": (('name    = "block"', 'name = "fixed pad"'), 'block "fixed pad": the name is used twice'),
    "no support": (
        ('role = "support"', 'role = "fixed"'),
        'settlement: no block has the role of support; give a [[block]] role = "support"',
    ),
    "no free block": (('name    = "block"', 'name = "block"\nrole = "fixed"'), "block: no block is free"),
    "misspelt role": (('"support"', '"suport"'), "block \"settling pad\".role = 'suport': must be 'free', 'fixed' or 'support'"),
    "zero direction": (("0.0, -1.0]", "0.0, 0.0]"), "settlement.direction = [0.0, 0.0, 0.0]: must not be the zero vector"),
    "zero gravity": (("-9.81", "0.0"), "gravity = [0.0, 0.0, 0.0]: must not be the zero vector"),
    "two numbers for a direction": (
        ("[0.0, 0.0, -1.0]", "[0.0, -1.0]"),
        "settlement.direction = [0.0, -1.0]: has too few entries; needed: direction of a translation",
    ),
    "one number for a direction": (
        ("[0.0, 0.0, -1.0]", "-1.0"),
        "settlement.direction = -1.0: must be an array; needed: direction of a translation",
    ),
    "a number for a corner": (
        (SHAPE, prism("[[0, 0], 1, [1, 1]]")),
        'block "block".prism.profile[1] = 1: must be an array; needed: corners (x, z) in order (m)',
    ),
    "four numbers for a direction": (
        ("0.0, -1.0]", "0.0, -1.0, 2.0]"),
        "settlement.direction = [0.0, 0.0, -1.0, 2.0]: has too many entries",
    ),
    "text for a number": (("= 0.6", '= "0.6"'), "joint.friction = '0.6': must be a number"),
    "bool for a number": (("= 0.6", "= true"), "joint.friction = true: must be a number"),
    "text for a coordinate": (("0.2, 0.5]", '0.2, "0.5"]'), "block \"block\".box.to[2] = '0.5': must be a number"),
    "number for a name": (('name    = "block"', "name = 3"), "block[2].name = 3: must be text in quotes"),
    "blank name": (('name    = "block"', 'name = "   "'), "name = '   ': must not be blank"),
    "number for a table": (
        (
            "[stone]\ndensity = 2000.0",
            "stone = 2000.0\n",
        ),
        "stone = 2000.0: must be a table",
    ),
    "array of tables for a table": (("[joint]", "[[joint]]"), "must be a table"),
    "neither motion nor load": ((MOTION, ""), "scene: needs one table out of [settlement], [live] and [tilt]; it has none"),
    "motion and load": (
        (MOTION, MOTION + "\n" + LIVE),
        "scene: needs one table out of [settlement], [live] and [tilt]; it has [settlement] and [live]",
    ),
    "support under a live load": ((MOTION, LIVE), 'live: a [live] scene has no support; give its held blocks role = "fixed"'),
    "a lift without a support": (
        (MOTION, LIVE + "\n[yade]\nwedging = 1e-5"),
        "yade.wedging: lifts the support, and a [live] scene has none; leave it out",
    ),
    "axis without point": ((MOTION, "[settlement]\naxis = [0.0, 1.0, 0.0]"), "both `axis` and `point` (rotation); it has `axis`"),
    "motion given twice": (
        (MOTION, MOTION + "\naxis = [0, 1, 0]\npoint = [0, 0, 0]"),
        "(rotation); it has `direction` and `axis` and `point`",
    ),
    "neither auto nor bool": ((MOTION, MOTION + '\n[effects]\nplane = "yes"'), "effects.plane = 'yes': must be 'auto', true or false"),
    "number for a bool": ((MOTION, MOTION + "\n[effects]\nplane = 1"), "effects.plane = 1: must be 'auto', true or false"),
    "misspelt friction model": (
        (MOTION, MOTION + '\n[effects]\nfriction = "colomb"'),
        "effects.friction = 'colomb': must be 'auto', 'coulomb', 'associated' or 'none-slides'",
    ),
    "no states of YADE": ((MOTION, MOTION + "\n[yade]\nposes = 0"), "yade.poses = 0: must be greater than 0"),
    "part of a thread": ((MOTION, MOTION + "\n[yade]\nthreads = 1.5"), "yade.threads = 1.5: must be a whole number"),
    "support that stands still": ((MOTION, MOTION + "\n[yade]\nspeed = 0"), "yade.speed = 0: must be greater than 0"),
    "too much local damping": ((MOTION, MOTION + "\n[yade]\ngravity_damping = 1"), "yade.gravity_damping = 1: must be less than 1"),
    "unstable time step": ((MOTION, MOTION + "\n[yade]\ntime_step_share = 1.01"), "yade.time_step_share = 1.01: must be at most 1: beyond"),
    "kind of expectation": (('"exact"', '"guess"'), "expected.kind = 'guess': must be 'exact', 'published' or 'computed'"),
    "part of a block": (
        (MOTION, WALL.replace("per_course = 4", "per_course = 2.5") + MOTION),
        "wall[0].per_course = 2.5: must be a whole number",
    ),
    "unknown bond": ((MOTION, WALL.replace("running", "english") + MOTION), "wall[0].bond = 'english': must be 'running' or 'stack'"),
    "opening off the courses": (
        (MOTION, WALL + "opening = [{ from = [0.4, 0.1], to = [0.8, 0.4], bearing = 0.1 }]\n" + MOTION),
        'wall "wall": opening = ((0.4, 0.1), (0.8, 0.4)): bottom and top must lie on course lines, multiples of 0.2 m',
    ),
    "opening without a lintel": (
        (MOTION, WALL + "opening = [{ from = [0.4, 0.2], to = [0.8, 0.8], bearing = 0.1 }]\n" + MOTION),
        "must leave a course for the lintel",
    ),
    "not TOML": ((MOTION, MOTION + "\n[["), "not valid TOML"),
    "key given twice": (("friction = 0.6", "friction = 0.6\nfriction = 0.7"), "not valid TOML"),
}


@pytest.mark.parametrize("case", CHANGED)
def test_bad_scene_is_refused_by_name(case, tmp_path, two_pads) -> None:
    changes, expected = CHANGED[case]
    path = tmp_path / "bad.toml"
    path.write_text(swapped(two_pads, *zip(changes[::2], changes[1::2], strict=True)), encoding="utf-8")
    assert expected in refusal(path)


def test_unchanged_scene_is_accepted(write_scene: WriteScene, two_pads) -> None:
    assert len(assemble(load_scene(write_scene(two_pads))).points) == 4


def test_a_share_of_the_time_step_is_not_judged_where_the_scene_gives_the_step(write_scene: WriteScene, two_pads) -> None:
    """YADE then does not use the share. Such scenes ran and agreed before this rule."""
    text = swapped(two_pads, (MOTION, MOTION + "\n[yade]\ntime_step_share = 1.2\ntime_step = 1e-6"))
    assert load_scene(write_scene(text)).yade == {"time_step_share": 1.2, "time_step": 1e-6}


def test_integers_are_numbers(write_scene: WriteScene, two_pads) -> None:
    """TOML distinguishes 1 from 1.0; a user need not."""
    scene = load_scene(write_scene(swapped(two_pads, ("= 0.6", "= 1"), ("to = [1.0, 0.2, 0.5]", "to = [1, 0.2, 0.5]"))))
    assert scene.friction == 1.0 and isinstance(scene.friction, float)


def test_support_that_touches_nothing_free(write_scene: WriteScene, two_pads) -> None:
    idle = scenes.box("idle pad", (1.0, 0.0, -0.1), (1.2, 0.2, 0.0), "support")
    text = swapped(two_pads, ('role = "support"', 'role = "fixed"'), (MOTION, idle + "\n" + MOTION))
    assert "settlement: no support block that moves touches a free block, so its motion changes nothing" in refusal(write_scene(text))


def test_support_whose_joint_is_too_short(write_scene: WriteScene, two_pads) -> None:
    """The support touches the block, so the message states the least length of a joint and not the nearest gap."""
    upper = [scenes.box(f"upper {k}", (0.0, 0.0, 0.5 * k), (1.0, 0.2, 0.5 * (k + 1))) for k in (1, 2)]
    narrow = swapped(two_pads, ("from = [0.5, 0.0, -0.1]", "from = [0.9998, 0.0, -0.1]"), (MOTION, "\n".join([*upper, MOTION])))
    told = refusal(write_scene(narrow))
    assert "settlement: the support blocks that move have no joint of 0.0005 m or more, and shorter ones do not count" in told
    assert "take a smaller inset" in told and "nearest" not in told


def test_mortar_that_is_not_drawn_between_the_structure_and_its_support(write_scene: WriteScene, two_pads) -> None:
    """The message states the width of the mortar. The pads touch each other, and so do the blocks, so each of them touches a block."""
    lowered = swapped(two_pads, ("to = [0.4, 0.2, 0.0]", "to = [0.5, 0.2, -0.01]"), ("to = [1.0, 0.2, 0.0]", "to = [1.0, 0.2, -0.01]"))
    upper = scenes.box("upper block", (0.0, 0.0, 0.5), (1.0, 0.2, 0.8))
    told = refusal(write_scene(swapped(lowered, (MOTION, upper + "\n" + MOTION))))
    assert 'changes nothing; "block" is nearest to "settling pad", about 0.01 m away; [geometry] tolerance closes gaps' in told


def test_plane_model_of_a_3d_scene(write_scene: WriteScene, two_pads) -> None:
    asked = (MOTION, MOTION + "\n[effects]\nplane = true")
    shallow = swapped(two_pads, asked, ("to = [0.4, 0.2, 0.0]", "to = [0.4, 0.1, 0.0]"))
    assert 'effects.plane = true: block "fixed pad" does not span the whole depth' in refusal(write_scene(shallow))
    askew = swapped(two_pads, asked, ("direction = [0.0, 0.0, -1.0]", "direction = [0.0, 0.1, -1.0]"))
    assert "effects.plane = true: the support does not move in the xz plane" in refusal(write_scene(askew))
    tilted = swapped(two_pads, asked, ("gravity = [0.0, 0.0, -9.81]", "gravity = [0.0, 1.0, -9.81]"))
    assert "effects.plane = true: gravity has a component along y" in refusal(write_scene(tilted))


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({}, ""),
        ({"settlement": (0.0, 1e-3, -1.0)}, "the support does not move in the xz plane"),
        ({"settlement": (0.0, -1e-5, -1.0)}, "the support does not move in the xz plane"),
        ({"settlement": {"axis": (1.0, 0.0, 0.0), "point": (0.0, 0.0, 0.0)}}, "the support does not move in the xz plane"),
        ({"settlement": {"axis": (0.0, 1.0, 1e-5), "point": (0.0, 0.0, 0.0)}}, "the support does not move in the xz plane"),
        ({"settlement": {"axis": (0.0, 1.0, 0.0), "point": (0.0, 0.0, 0.0)}}, ""),
        ({"settlement": {"axis": (0.0, -1.0, 0.0), "point": (0.5, 7.0, 0.2)}}, ""),
        ({"gravity": (0.0, 0.01, -9.81)}, "gravity has a component along y"),
        ({"gravity": (0.0, -1e-4, -9.81)}, "gravity has a component along y"),
        ({"live": (1.0, 0.01, 0.0)}, "the live load has a component along y"),
        ({"live": (1.0, -1e-5, 0.0)}, "the live load has a component along y"),
        ({"live": (1.0, 0.0, 0.5)}, ""),
    ],
)
def test_plane_model_is_taken_where_the_scene_allows_it(options, reason) -> None:
    scene = scenes.build(*scenes.wall(3, 3, split=None if "live" in options else 0.4), **options)
    effects = assemble(scene).effects
    assert effects.plane is (reason == "")
    assert reason in effects.reasons["plane"]


@pytest.mark.parametrize(
    ("shape", "reason"),
    [
        ({"box": ((0.0, 0.0, 0.0), (1.0, 1.0, 0.5))}, ""),
        ({"box": ((0.0, 0.1, 0.0), (1.0, 1.0, 0.5))}, 'block "stone" does not span the whole depth, y = 0 to 1 m'),
        ({"box": ((0.0, 0.0, 0.0), (1.0, 0.9, 0.5))}, 'block "stone" does not span the whole depth, y = 0 to 1 m'),
        (
            {"polyhedron": [(x, y, z) for y, right in ((0.0, 1.0), (1.0, 0.7)) for x in (0.0, right) for z in (0.0, 0.5)]},
            'block "stone" is not a prism along y',
        ),
    ],
    ids=["whole", "begins later", "ends sooner", "tapered"],
)
def test_a_block_that_differs_along_the_depth_makes_the_model_one_in_space(shape, reason) -> None:
    effects = assemble(
        scenes.build(scenes.block("stone", **shape), scenes.box("base", (0.0, 0.0, -0.2), (1.0, 1.0, 0.0), "support"))
    ).effects
    assert effects.plane is (reason == "") and reason in effects.reasons["plane"]


def test_file_that_is_missing(tmp_path) -> None:
    message = refusal(tmp_path / "nowhere.toml")
    assert "cannot be read: No such file" in message and "crosscheck scenes" in message


def test_folder_for_a_file(tmp_path) -> None:
    assert "cannot be read: Is a directory" in refusal(tmp_path)


def test_file_that_is_not_text(tmp_path, two_pads) -> None:
    path = tmp_path / "latin.toml"
    path.write_bytes(two_pads.replace("Right", "Tässä").encode("latin-1"))
    assert "not UTF-8 text" in refusal(path)


def test_empty_file(write_scene: WriteScene) -> None:
    assert "joint: missing" in refusal(write_scene(""))


def test_long_values_are_cut_short(write_scene: WriteScene, two_pads) -> None:
    message = refusal(write_scene(swapped(two_pads, ("= 0.6", f'= "{"x" * 5000}"'))))
    assert "joint.friction" in message and len(message) < 400


def test_held_block_may_lack_a_density(write_scene: WriteScene, two_pads) -> None:
    scene = load_scene(write_scene(swapped(two_pads, ("[stone]\ndensity = 2000.0", ""))))
    assert scene.weight == pytest.approx(220.0 * 9.81)
