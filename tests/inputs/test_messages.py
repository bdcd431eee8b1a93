"""Messages about a scene file give all errors at once, each with its line and a next step. Files that are no scenes are named."""

import shlex
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from comparison.cli.commands import main
from la_core.analysis.modelling import structural_model
from la_core.errors import SceneError, nearest
from la_core.scene import shipped
from la_core.scene.line_numbers import key_lines, line_of
from la_core.scene.scene import load_scene
from la_core.scene.shipped import starter_names, starter_text
from la_core.scene.variants import build

WriteScene = Callable[[str], Path]

MANY = """title = "Many mistakes"
[stone]
density = -1.0
[joint]
fricton = 0.6
[[wall]]
origin = [0.0, 0.0, 0.0]
block = [0.4, 0.2, 0.2]
per_course = 4
courses = 4
opening = [
  { from = [0.4, 0.2], to = [0.8, 0.4] },
]
[[wall]]
bond = "english"
origin = [0.0, 0.0, 0.0]
block = [0.4, 0.2, 0.2]
per_course = 4
courses = 4
[settlement]
direction = [0.0, 0.0, -1.0]
"""
EXPECTED = """6 errors
  line 3: stone.density = -1.0: must be greater than 0
  line 5: joint.fricton: unknown key; did you mean "friction"?
  line 6: wall[0].bond: missing; choose "running" or "stack": running: every other course is shifted by half a block; stack: vertical
  line 12: wall[0].opening[0].bearing: missing; needed: length by which the head extends beyond the opening on either side; of a
  line 15: wall[1].bond = 'english': must be 'running' or 'stack'
"""


def message(path: Path) -> str:
    with pytest.raises(SceneError) as error:
        load_scene(path)
    return str(error.value).removeprefix(f"{path}: ")


def test_all_errors_of_a_file_come_at_once_each_with_its_line(write_scene: WriteScene) -> None:
    told = message(write_scene(MANY + "[live]\n")).splitlines()
    for line, start in zip(told, EXPECTED.splitlines(), strict=False):
        assert line.startswith(start), line
    assert told[-1] == "  line 22: live.direction: missing; needed: direction of the load, of any length"


def test_what_cannot_be_built_is_told_of_every_table(write_scene: WriteScene, two_pads: str) -> None:
    bad = '[[block]]\nname = "{}"\nprism = {{ profile = [[0, 0], [1, 0], [2, 0]], y = [0, 1] }}\n'
    told = message(write_scene(f"{two_pads}\n{bad.format('first')}{bad.format('second')}"))
    first = len(two_pads.splitlines()) + 2
    assert told.splitlines() == [
        "2 errors",
        f'  line {first}: block "first": the profile has no area',
        f'  line {first + 3}: block "second": the profile has no area',
    ]


def test_of_very_many_errors_the_rest_is_counted(write_scene: WriteScene, two_pads: str) -> None:
    told = message(write_scene(two_pads + "".join(f'[[block]]\nname = "{k}"\ndensity = -1.0\n' for k in range(50)))).splitlines()
    assert (told[0], len(told), told[-1]) == ("50 errors", 22, "  and 30 more")


def test_the_meaning_of_keys_is_told_once(write_scene: WriteScene, two_pads: str) -> None:
    block = '[[block]]\nname = "{}"\nprism = {{ profile = [[0, 0], [1, 0], [1, 1]], qqq = [0, 1] }}\n'
    told = message(write_scene(two_pads + block.format("first") + block.format("second"))).splitlines()
    assert sum(line.endswith("unknown key; valid keys: profile, y") for line in told) == 2
    assert sum(line.strip().startswith("profile  corners") for line in told) == 1


def test_a_scene_made_in_code_has_no_lines() -> None:
    with pytest.raises(SceneError) as error:
        build({"joint": {"friction": -1.0}, "settlement": {"direction": [0, 0, -1]}})
    assert "line" not in str(error.value)


def test_an_unknown_key_like_no_other_brings_the_valid_ones_with_their_meaning(write_scene: WriteScene, two_pads: str) -> None:
    told = message(write_scene(two_pads.replace("direction = [0.0", "qqq = 1\ndirection = [0.0")))
    assert "settlement.qqq: unknown key; valid keys: direction, axis, point, zone, profile, along\n" in told
    assert "\n  direction  direction of a translation, of any length; down is [0, 0, -1]\n" in told
    assert "\n  point      a point on this axis (m)\n" in told


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("= 0.6", "= 0,6", "write numbers with a decimal point, 0.6"),
        ("= 0.6", "= 0,6  # the “mu”", "write numbers with a decimal point, 0.6"),
        ("= 2200.0", "= 2,200", "write numbers with a decimal point and no other mark: 2200, or 2.200 if the comma is a decimal mark"),
        ("= 0.6", "= 0,600", "write numbers with a decimal point, 0.600"),
        ("= 2200.0", "= 2.200,5", "write numbers with a decimal point and no other mark, as in 2200.5"),
        ("= 2200.0", "= 2'200", "write numbers with a decimal point and no other mark, as in 2200.5"),
        ("= 0.6", "= 60 %", "write the number alone, as a share of one: 0.6 for 60 %"),
        ("= 0.6", "= 0.6;", "a line ends without a semicolon"),
        ('= "support"', "= „support“", "write text in straight quotes"),
        ("-1.0]", "−1.0]", "write a minus sign with the key -"),
        ("= 0.6", "= 0.6 – 0.1", "write a minus sign with the key -"),
        ("= 0.6", "\u00a0= 0.6", "a space on this line is no plain one"),
        ("= 0.6", "= 0.6 // measured", "a comment begins with #, not with //"),
        ("= 0.6", ": 0.6", "write = between a key and its value"),
        ("{ from =", "{ from:", "write = between a key and its value"),
        ("[0.0, 0.0, -1.0]", "(0.0, 0.0, -1.0)", "write lists in square brackets"),
        ("= 0.6", "= 0,6  # = tan(31)", "write numbers with a decimal point, 0.6"),
        ("= 0.6", "= .6  # about\u00a031 degrees", "write a digit on both sides of a decimal point"),
        ('= "support"', "= single", "write text in quotes"),
        (", to = [", ", a = 1.0 to = [", "write a comma between two keys of a table in braces"),
        ("= 0.6", "= tan(31)", "a scene does not calculate: write the number that comes out"),
        ("= 0.6", "= math.tan(0.5)", "a scene does not calculate: write the number that comes out"),
        ("= 0.6", "= 3/5", "a scene does not calculate: write the number that comes out"),
        ("[0.0, 0.0, -1.0]", "[0.0, 0.0, -1/2]", "a scene does not calculate: write the number that comes out"),
        ("= 0.6", "= 27/11/2026", "Expected newline or end of document after a statement (at line 9, column 14)"),
        ("= 0.6", "= .6", "write a digit on both sides of a decimal point"),
        ("[0.0, 0.0, -1.0]", "[0., 0., -1.]", "write a digit on both sides of a decimal point"),
        ("[settlement]", "[effects]\nplane = True\n[settlement]", "write true or false in small letters"),
        ("0.0] }", "0.0], }", "no comma stands before the closing brace"),
        ("{ from", "{\n  from", "a table in braces { } begins and ends on one line"),
        (", to = [", ",\n  to = [", "a table in braces { } begins and ends on one line"),
        ("[[block]]", "[block]", "have double brackets, as [[block]]"),
        ("= 0.6", "= 0.6\nfriction = 0.5", "the key stands twice; give it once"),
        ("[joint]", "[[joint]]", "must be a table; write it below [joint] in single brackets, or as { ... }"),
        (
            "[settlement]",
            '[tie]\nblocks = ["block"]\nfrom = [1, 0, 0]\nto = [2, 0, 0]\nforce = 1e3\n[settlement]',
            "rods of given tension; write it below [[tie]] in double brackets, or as [{ ... }]",
        ),
        (
            "[0.0, 0.0, -1.0]",
            '[0.0, 0.0, -1.0]\nzone = { blocks = ["settling pad"], ratio = 0.5 }',
            "write it below [[settlement.zone]] in double brackets, or as [{ ... }]",
        ),
        ("= 0.6", '= "60 %"', "write the number alone, without quotes, as a share of one: 0.6 for 60 %"),
        ("= 0.6", "= 35 degrees", "write the number alone, 35; the friction is the tangent of the angle"),
        ("= 0.6", '= "35 degrees"', "the friction of 35 degrees is the tangent of this angle, 0.700"),
        ("= 2200.0", "= 22 kN/m3", "write the number alone, 22; all numbers are in SI units (m, kg, N)"),
        ("= 2200.0", '= "2.2 t/m3"', "without quotes and unit: 2.2; all numbers are in SI units (m, kg, N, s)"),
        ("= 2200.0", '= "2200 kg/m3"', "write the number alone, without quotes and unit: 2200"),
        ("= 2200.0", '= "2200,5"', "write the number alone, without quotes: 2200.5"),
        ("[1.0, 0.2, 0.5]", "[1,0, 0,2, 0,5]", "a decimal comma makes two numbers of one, so write 0.6 instead of 0,6"),
        ('= "support"', "= support", "write text in quotes"),
        ("= 0.6", "= 0.6\ncohesion = 0.1", "joint.cohesion: joints are dry and carry neither cohesion nor tension: bounds"),
        (
            "[settlement]",
            '[[friction]]\njoints = "bed"\nfriction = 0.5\ntension = 1e4\n[settlement]',
            "friction[0].tension: joints are dry",
        ),
        (
            "[settlement]",
            '[[friction]]\njoints = "bed"\nfriction = 0.5\ncohesion = 1e4\n[settlement]',
            "; leave it out, and give stones that",
        ),
        ("= 2200.0", "= 2200.0\ncohesion = 0.1", "cohesion: unknown key; joints have none: they are dry"),
        (
            "[settlement]",
            '[[tie]]\nblocks = ["block"]\nfrom = [1, 0, 0]\nto = [2, 0, 0]\ntension = 1e3\n[settlement]',
            "tie[0].tension: the tension of a tie is its `force`, in N",
        ),
        ("= 0.6", "= 0.6\nload = 100.0", "joint.load: unknown key; dead loads stand in [[load]] tables of their own"),
        ("[settlement]", '[[sweep]]\nscene = "wall"\n[settlement]', "sweep: unknown key; this is a campaign, not a scene"),
        (
            "[settlement]",
            "[live]\ndirection = [1, 0, 0]\n[settlement]",
            "needs one table out of [settlement], [live] and [tilt]; it has [settlement] and [live]",
        ),
    ],
)
def test_a_common_slip_is_recognised(old: str, new: str, expected: str, tmp_path: Path, two_pads: str) -> None:
    assert old in two_pads
    path = tmp_path / "slip.toml"
    path.write_text(two_pads.replace(old, new, 1), encoding="utf-8")
    assert expected in message(path)


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("[0.0, 0.0, -1.0]", "{ x = 0.0, y = 0.0, z = -1.0 }", "settlement.direction"),
        ("[0.0, 0.0, -1.0]", "[0.0, 0.0, -1.0]\nprofile = [{ at = 0.4, share = 0.0 }, [1.0, 1.0]]", "settlement.profile[0]"),
        ("[0.0, 0.0, -1.0]", '[0.0, 0.0, -1.0]\nzone = [{ blocks = { a = "settling pad" } }]', "settlement.zone[0].blocks"),
    ],
)
def test_a_table_in_place_of_numbers_or_names_is_not_told_to_have_double_brackets(
    old: str, new: str, key: str, tmp_path: Path, two_pads: str
) -> None:
    path = tmp_path / "slip.toml"
    path.write_text(two_pads.replace(old, new, 1), encoding="utf-8")
    told = message(path)
    assert f"{key} = " in told and "must be an array" in told and "brackets" not in told


def test_a_file_in_another_encoding_is_to_be_saved_as_utf_8(tmp_path: Path, two_pads: str) -> None:
    path = tmp_path / "latin.toml"
    path.write_bytes(f'# A comment\ntitle = "façade"\n{two_pads}'.encode("latin-1"))
    assert message(path).startswith("not UTF-8 text (byte 23, line 2); save the file in the encoding UTF-8")


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("joint".encode("utf-16-le"), "not UTF-8 text: it holds zero bytes, as UTF-16 does; save the file in the encoding UTF-8"),
        ("joint".encode("utf-16"), "not UTF-8 text: it holds zero bytes, as UTF-16 does; save the file in the encoding UTF-8"),
        (b"{\\rtf1\\ansi", "a file of a word processor, not plain text; save it there as plain text"),
        (b"PK\x03\x04\x14\x00", "a file of a word processor, not plain text; save it there as plain text"),
    ],
)
def test_what_is_no_plain_text_is_told_so(content: bytes, expected: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    assert message(path).startswith(expected)


def test_a_campaign_in_place_of_a_scene_is_one_message(tmp_path: Path) -> None:
    path = tmp_path / "class 3.toml"
    path.write_text('title = "x"\n[[sweep]]\nscene = "two_pads"\n[labels]\n"joint.friction" = "mu"\n', encoding="utf-8")
    assert message(path) == f"is a campaign, not a scene; `crosscheck campaign '{path}'` runs it"


@pytest.mark.parametrize(
    ("name", "kind", "source"),
    [
        ("wall.obj", "a mesh", "wall.obj"),
        ("WALL.STL", "a mesh", "WALL.STL"),
        ("plan.dxf", "a drawing", "plan.dxf"),
        ("plan.svg", "a drawing", "plan.svg"),
        ("plan.dwg", "a drawing", "plan.dxf"),
        ("assembly.json", "a JSON file", "assembly.json"),
        ("a.png", "a drawing or a picture", None),
        ("blocks.csv", "a spreadsheet", None),
        ("plan of wall.svg", "a drawing", "plan of wall.svg"),
    ],
)
def test_another_file_in_place_of_a_scene_says_what_to_do(name: str, kind: str, source: str | None, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(b"v 0 0 0\n")
    told = message(path)
    assert told.startswith(f"is {kind}, not a scene; ")
    if source is None:
        assert "`crosscheck new` lists kinds" in told
    else:
        assert f"`crosscheck new --from {shlex.quote(str(tmp_path / source))}` writes a scene for it" in told.replace(
            "then writes", "writes"
        )


def test_a_line_is_that_of_the_key_or_of_the_nearest_table_around_it() -> None:
    text = (
        'a.b = 1 # x = 2\n[t]\n"k" = """\nx = 1\n"""\nl = [ # c\n  [1, 2],\n  { m = 3 },\n]\n[[u.v]]\n[[u.v]]\nw = \'#\'\n[u.v.z]\ny = 1\n'
    )
    lines = key_lines(text)
    places = {("a", "b"): 1, ("t", "k"): 3, ("t", "l", 0, 1): 7, ("t", "l", 1, "m"): 8, ("u", "v", 1, "w"): 12, ("u", "v", 1, "z", "y"): 14}
    assert {place: lines[place] for place in places} == places
    assert line_of(lines, ("u", "v", 0, "missing")) == 10 and line_of(lines, ("nowhere",)) is None


@pytest.mark.parametrize(
    "text", [*map(starter_text, starter_names()), *(shipped.find(name).read_text("utf-8") for name in shipped.names())]
)
def test_every_key_of_a_scene_has_its_line(text: str) -> None:
    """The scan finds the same keys as the parser of the standard library, each on a line with the name of the key."""

    def places(value: object, place: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
        inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        return [place, *(found for key, one in inner for found in places(one, (*place, key)))]

    lines = key_lines(text)
    assert set(lines) == set(places(tomllib.loads(text))) - {()}
    rows = text.splitlines()
    assert all(str(place[-1]) in rows[line - 1] for place, line in lines.items() if isinstance(place[-1], str))


LATE = """[stone]
density = 2000.0
[joint]
friction = 0.6
{joint}
[[block]]
name = "left"
role = "fixed"
box = {{ from = [0.0, 0.0, -0.5], to = [0.5, 1.0, 0.0] }}
[[block]]
name = "right"
role = "{role}"
box = {{ from = [0.5, 0.0, -0.5], to = [1.0, 1.0, 0.0] }}
[[block]]
name = "stone"
box = {{ from = [0.0, 0.0, {foot}], to = [1.0, 1.0, 1.0] }}
{more}
[settlement]
direction = [0.0, 0.0, -1.0]
{end}
"""
PLAIN = {"joint": "", "role": "support", "foot": "0.0", "more": "", "end": ""}
WALL_TOO_LOW = '[[wall]]\nbond = "stack"\norigin = [0, 0, 0.9]\nblock = [1, 1, 1]\nper_course = 1\ncourses = 1'
NOT_PLANE = '[effects]\nplane = true\n[[block]]\nname = "b"\nbox = { from = [0, 0, 1], to = [1, 0.5, 2] }'
TWICE = '[[block]]\nname = "stone"\nbox = { from = [0, 0, 1], to = [1, 1, 2] }'
THIN = '[[block]]\nname = "thin"\nbox = { from = [0, 0, 1], to = [1, 1, 1.0000000001] }'
OVERLAP = 'lines 6 and 14: blocks "left" and "stone": overlap by about 0.01 m; so do "right" and "stone" by 0.01 m'
FOUND_LATE = {  # changes of the scene, and the beginning of the message
    "overlap": ({"foot": "-0.01"}, OVERLAP),
    "gap": ({"foot": "0.01"}, 'line 14: block "stone": touches nothing'),
    "generated": ({"more": WALL_TOO_LOW}, 'lines 14 and 17: blocks "stone" and "wall 1.1": overlap by about 0.1 m'),
    "inset": ({"joint": "inset = 0.6"}, "line 5: joint.inset = 0.6: larger than half the interface"),
    "effect": ({"end": NOT_PLANE}, "line 21: effects.plane = true"),
    "setting": ({"end": "[yade]\nmax_travel = -1.0"}, "line 21: yade.max_travel"),
    "roles": ({"role": "fixed"}, "line 18: settlement: no block has the role of support"),
    "name": ({"more": TWICE}, 'line 17: block "stone": the name is used twice'),
    "thin": ({"more": THIN}, 'line 17: block "thin": is 1e-10 m'),
}


@pytest.mark.parametrize("name", FOUND_LATE)
def test_what_is_found_after_the_blocks_are_built_has_its_lines(name: str, tmp_path: Path) -> None:
    changes, words = FOUND_LATE[name]
    path = tmp_path / "late.toml"
    path.write_text(LATE.format(**PLAIN | changes))
    with pytest.raises(SceneError) as error:
        structural_model(load_scene(path))
    assert str(error.value).startswith(f"{path}: {words}"), error.value


def test_faults_between_tables_come_at_once(tmp_path: Path) -> None:
    path = tmp_path / "late.toml"
    path.write_text(LATE.format(**PLAIN | {"role": "fixed", "more": TWICE, "end": "[yade]\nsped = 1.0"}))
    told = message(path).splitlines()
    assert [line[:10] for line in told] == ["3 errors", "  line 17:", "  line 20:", "  line 23:"]


def test_show_draws_what_is_to_be_corrected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, figure = tmp_path / "late.toml", tmp_path / "late.png"
    path.write_text(LATE.format(**PLAIN | {"foot": "-0.01"}))
    assert main(["show", str(path), "-o", str(figure)]) == 2
    assert figure.read_bytes()[:4] == b"\x89PNG"
    said = capsys.readouterr().err
    assert "with a red cross at each place to correct" in said and "overlap by about 0.01 m" in said


def test_a_hint_lists_the_first_of_many_names() -> None:
    assert nearest("zzz", [f"wall {k}" for k in range(200)], "names").endswith("wall 8, wall 9, ... (200 in all)")
    assert nearest("wall 1999", [f"wall {k}" for k in range(200)], "names") == 'did you mean "wall 199"?'


TWO_WALLS = WALL_TOO_LOW.replace("courses = 1", "courses = 2") + "\n" + WALL_TOO_LOW.replace("courses = 1", "courses = 2")
COPY = '[[block]]\nname = "copy"\nbox = { from = [0, 0, 0], to = [1, 1, 1] }'


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (TWO_WALLS, 'block "wall 1.1": the name is used twice, like that of 1 other block of this table; give each [[wall]] a `name`'),
        (COPY, 'blocks "stone" and "copy": overlap by about 1 m; blocks may touch but not share volume; these two fill the same place'),
    ],
)
def test_what_is_there_twice_is_said_once_with_the_way_to_mend_it(more: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "twice.toml"
    path.write_text(LATE.format(**PLAIN | {"more": more}))
    with pytest.raises(SceneError) as error:
        structural_model(load_scene(path))
    assert words in str(error.value) and str(error.value).count("used twice") <= 1
