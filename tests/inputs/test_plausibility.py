"""Allowed but implausible values: each causes a warning in every output that a user reads, and never an error."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scenes

import la_core
from comparison.cli.commands import main
from comparison.report.report import write_report
from la_core.scene import shipped
from la_core.scene.scene import load_scene

WriteScene = Callable[[str], Path]
LOAD = '[[load]]\nblocks = ["block"]\nforce = [{}\n'
AS_SEEN = {  # change of the example of two pads, and words of the warning
    "an angle for friction": (("friction = 0.6", "friction = 35.0"), "joint.friction = 35 is above 1.2", "35 degrees is 0.700"),
    "friction beyond stone": (("friction = 0.6", "friction = 1.5"), "joint.friction = 1.5 is above 1.2"),
    "a weight for density": (("2200.0", "18.0"), "density = 18 kg/m3 lies outside 500 to 4000", "kN/m3, write 1835"),
    "tonnes for density": (("2200.0", "2.2"), "density = 2.2 kg/m3 lies outside", "t/m3, write 2200"),
    "a heavy stone": (("2200.0", "9000.0"), "density = 9000 kg/m3 lies outside 500 to 4000"),
    "a lift": (("0.0, -1.0]", "0.0, 1.0]"), "the support moves against gravity"),
    "a turn that lifts": (
        ("direction = [0.0, 0.0, -1.0]", "axis = [0.0, -1.0, 0.0]\npoint = [0.0, 0.0, 0.0]"),
        "the support moves against gravity",
        "or an axis about which the support sinks",
    ),
    "a load in kN": (("[settlement]", LOAD.format("0.0, 0.0, -0.001]") + "[settlement]"), 'load "load" is 0.001 N', "in N, not in kN"),
    "a load that lifts": (("[settlement]", LOAD.format("0.0, 0.0, 900.0]") + "[settlement]"), 'load "load" lifts'),
    "a huge load": (("[settlement]", LOAD.format("0.0, 0.0, -9e9]") + "[settlement]"), "more than 10 times the weight"),
    "a load beside its block": (
        ("[settlement]", LOAD.format("0.0, 0.0, -900.0]\nat = [9.0, 0.5, 0.3]") + "[settlement]"),
        'load "load" acts',
        'm outside its block "block"',
    ),
    "a line that leaves its block": (
        (
            "[settlement]",
            '[[load]]\nblocks = ["block"]\nmass = 100.0\nper = "m"\nfrom = [0.5, 0.1]\nto = [1.5, 0.1]\n[settlement]',
        ),
        "only 0.5 of 1 m of its line lie over top faces of its blocks",
    ),
    "a tie to the support": (
        (
            "[settlement]",
            '[[tie]]\nblocks = ["block", "settling pad"]\nfrom = [0.8, 0.1, 0.4]\nto = [0.8, 0.1, 0.0]\nforce = 200.0\n[settlement]',
        ),
        'tie "tie" ends at a support: the reaction is the force of its joints alone',
    ),
    "a share in percent": (
        ("[settlement]", '[settlement]\nzone = [{ blocks = ["settling pad"], ratio = 40.0 }]'),
        "settlement.zone[0].ratio: 40 times the settlement is large; a share is no percentage: write 0.4 for 40 %",
    ),
    "a profile in percent": (
        ("direction = [0.0, 0.0, -1.0]", "direction = [0.0, 0.0, -1.0]\nprofile = [[0.4, 0.0], [1.0, 80.0]]"),
        "settlement.profile[1]: 80 times the settlement",
    ),
    "a profile that bends over a support": (
        ("direction = [0.0, 0.0, -1.0]", "direction = [0.0, 0.0, -1.0]\nprofile = [[0.5, 1.0], [0.7, 0.9], [1.0, 1.0]]"),
        "settlement.profile bends at x = 0.7 m, within the support",
        "only the ratios at both its ends count",
    ),
    "a rough class of joints": (("[settlement]", '[[friction]]\njoints = "footing"\nfriction = 35.0\n[settlement]'), "is above 1.2"),
    "a travel beyond the inset": (
        ("[settlement]", "[yade]\nmax_travel = 0.01\n[settlement]"),
        "max_travel = 0.01 moves blocks by 10 mm in YADE",
        "at most 0.0008: 0.8 of the inset of 1 mm",
    ),
    "a turn beyond the inset": (
        (
            "direction = [0.0, 0.0, -1.0]",
            "axis = [0.0, 1.0, 0.0]\npoint = [-1.0, 0.0, 0.0]\n[yade]\nmax_travel = 0.0005",
        ),
        "max_travel = 0.0005 moves blocks by 1",
    ),
    "a lift beyond the inset": (
        ("[settlement]", "[yade]\nwedging = 1\n[settlement]"),
        "wedging = 1 moves blocks by 1e+03 mm in YADE",
        "at most 0.0008: 0.8 of the inset of 1 mm",
    ),
    "a curve over more than a twentieth of a block": (
        ("[settlement]", "[path]\nsettlement = 0.1\n[settlement]"),
        "path.settlement = 0.1 moves blocks by 0.22 times a block's size",
        "lever arms stay those of the structure as built, with finite rotations, too. Do not use the curve beyond about 0.023: ",
    ),
    "a tolerance that any answer meets": (
        ("tolerance                = 1e-6", "tolerance = 0.1"),
        "expected.tolerance = 0.1 is 60 % of reaction_over_weight = 0.166667",
    ),
    "gravity of the moon": (("-9.81", "-1.62"), "gravity is 1.62 m/s2"),
}
WALL_OF_MILLIMETRES = """
[stone]
density = 2000.0
[joint]
friction = 0.6
[[wall]]
bond = "stack"
origin = [0.0, 0.0, 0.0]
block = [600.0, 400.0, 300.0]
per_course = 2
courses = 2
footing = { height = 300.0, settling = [600.0, 1200.0] }
[settlement]
direction = [0.0, 0.0, -1.0]
"""


def changed(text: str, swap: tuple[str, str]) -> str:
    assert text.count(swap[0]) == 1, swap
    return text.replace(*swap)


def warnings_of(path: Path) -> str:
    return " ".join(load_scene(path).warnings)


@pytest.mark.parametrize("case", AS_SEEN)
def test_an_implausible_value_brings_one_warning_that_says_what_may_be_meant(case: str, write_scene: WriteScene, two_pads: str) -> None:
    swap, *expected = AS_SEEN[case]
    scene = load_scene(write_scene(changed(two_pads, swap)))
    assert len(scene.warnings) == 1
    assert all(words in scene.warnings[0] for words in expected)


@pytest.mark.parametrize("name", [name for name in shipped.names() if name not in shipped.LONG])
def test_no_shipped_scene_brings_a_warning(name: str) -> None:
    assert scenes.shipped(name).warnings == ()


def test_an_angle_in_radians_is_told_in_degrees() -> None:
    (told,) = la_core.variant("arch_spreading", {"arch[0].embrace": 3.14159}).warnings
    assert told == "arch[0].embrace = 3.14159 is a very small angle; it is in degrees: 3.14159 radians are 180 degrees."


def test_a_floor_on_a_block_is_no_heavy_stone() -> None:
    """The mass of a floor raises the density of its blocks in the model, but not that of their stone."""
    scene = scenes.shipped("building_corner")
    assert scene.blocks.density.max() > 4000.0 and scene.warnings == ()


def test_a_wall_in_millimetres_is_longer_than_any_block_and_heavier_than_any_building(write_scene: WriteScene) -> None:
    told = warnings_of(write_scene(WALL_OF_MILLIMETRES))
    assert '4 blocks ("wall 1.1", "wall 1.2", "wall 2.1", ...) are longer than 10 m (up to 600 m)' in told
    assert "weigh 5.65e+12 N, more than any known building" in told


def test_a_block_thinner_than_a_tile_is_named(write_scene: WriteScene, two_pads: str) -> None:
    told = warnings_of(write_scene(changed(two_pads, ("to = [1.0, 0.2, 0.5]", "to = [1.0, 0.2, 0.005]"))))
    assert told == 'block "block" is thinner than 10 mm (down to 5 mm); coordinates are in metres.'


def test_ground_may_be_long_and_a_spreading_or_turning_support_is_no_lift(write_scene: WriteScene, two_pads: str) -> None:
    text = changed(two_pads, ("from = [0.0, 0.0, -0.1]", "from = [-20.0, 0.0, -0.1]"))
    for motion in ("direction = [1.0, 0.0, 0.0]", "axis = [0.0, 1.0, 0.0]\npoint = [0.4, 0.0, 0.0]"):
        assert warnings_of(write_scene(changed(text, ("direction = [0.0, 0.0, -1.0]", motion)))) == ""
    backward = "axis = [0.0, -1.0, 0.0]\npoint = [0.4, 0.0, 0.0]"
    assert "against gravity" in warnings_of(write_scene(changed(text, ("direction = [0.0, 0.0, -1.0]", backward))))


@pytest.mark.parametrize(("direction", "lifts"), [("[-1.0, 0.0, 0.0]", False), ("[-1.0, 0.0, 0.1]", True), ("[-1.0, 0.0, -0.1]", False)])
def test_under_gravity_aslant_a_level_support_lifts_nothing(write_scene: WriteScene, two_pads: str, direction: str, lifts: bool) -> None:
    """Each of these motions has a component against gravity, but only one of them rises."""
    aslant = changed(two_pads, ("gravity = [0.0, 0.0, -9.81]", "gravity = [2.0, 0.0, -9.6]"))
    text = changed(aslant, ("direction = [0.0, 0.0, -1.0]", f"direction = {direction}"))
    assert ("against gravity" in warnings_of(write_scene(text))) == lifts


def test_a_warning_stands_in_every_answer_and_in_the_report(
    write_scene: WriteScene, two_pads: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    path = write_scene(changed(two_pads, ("friction = 0.6", "friction = 2.0")))
    results = tmp_path / "results"
    for command in (["show"], ["solve", "--results", str(results)], ["run", "--no-yade", "-o", str(results)]):
        assert main([command[0], str(path), "-q", "--json", *command[1:]]) == 0
        printed = capsys.readouterr()
        assert f"warning: {path.stem}: joint.friction = 2 is above 1.2" in printed.err
        said = json.loads(printed.out)
        (warning,) = said["warnings"] if "warnings" in said else said["comparisons"][0]["warnings"]
        assert warning.startswith("joint.friction = 2")
    comparison = json.loads((results / path.stem / "comparison.json").read_text(encoding="utf-8"))
    write_report(results, [comparison], {})
    for page in ("report.html", "report.md"):
        assert "Warning: joint.friction = 2 is above 1.2" in (results / page).read_text(encoding="utf-8").replace("\\", "")


def test_one_lifted_support_among_others_that_sink_is_named(write_scene: WriteScene, two_pads: str) -> None:
    zones = """direction = [0.0, 0.0, -1.0]
[[settlement.zone]]
blocks = ["fixed pad"]
ratio = {}"""
    both = changed(two_pads, ('role = "fixed"', 'role = "support"'))
    for ratio, told in ((-0.5, "is lifted, while the support sinks as a whole."), (0.5, "")):
        text = changed(both, ("direction = [0.0, 0.0, -1.0]", zones.format(ratio)))
        words = warnings_of(write_scene(text))
        assert words.endswith(told) and ("fixed pad" in words) == bool(told)


@pytest.mark.parametrize("angle", np.linspace(0.1, 6.2, 12))
def test_a_force_across_a_turned_gravity_does_not_lift_by_round_off(angle: float) -> None:
    turn = scenes.rotation((1.0, 2.0, 3.0), float(angle))
    down, across = 9.81 * turn @ np.array([0.0, 0.0, -1.0]), 900.0 * turn @ np.array([0.6, 0.8, 0.0])
    parts = scenes.wall(3, 2, split=0.8)
    load = scenes.table("[load]", name="wind", blocks=["wall 2.*"], force=across.tolist())
    said = scenes.build(*parts, load, gravity=down.tolist(), settlement=(down / 9.81).tolist()).warnings
    assert not any("lifts" in words for words in said)
