"""A campaign file defines its cases: wrong files are refused, and every case has a name of its own."""

from dataclasses import replace
from pathlib import Path

import pytest
from campaigns import run, sweep, written

from comparison.campaign.cases import LONGEST, axes, expand
from comparison.campaign.definition import MOST_CASES, load_campaign
from comparison.campaign.report.compare import compare_tables
from comparison.campaign.report.report import write_campaign_report
from comparison.cli.commands import main
from comparison.cli.study_verbs.campaign import find_campaign
from la_core.errors import SceneError
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find

WRONG = {
    "not TOML": ("sweep = [", "not valid TOML"),
    "no sweep": ('title = "nothing"', "sweep: missing"),
    "a scene": ("[joint]\nfriction = 0.6\n[stone]\ndensity = 2000.0", "the file: is a scene, not a campaign; a campaign names it"),
    "misspelt key": ('yad = true\n[[sweep]]\nscene = "two_pads"', 'yad: unknown key; did you mean "yade"?'),
    "misspelt key of a sweep": (sweep("[sweep.varry]\na = [1]"), 'varry: unknown key; did you mean "vary"?'),
    "wrong type": ('yade = "no"\n[[sweep]]\nscene = "two_pads"', "yade = 'no': must be true or false"),
    "unknown scene": (sweep("", "two_padz"), 'did you mean "two_pads"?'),
    "missing scene file": (sweep("", "nowhere.toml"), "nowhere.toml: cannot be read"),
    "a name of two lines": (sweep("", "two_pads") + 'name = "a\\nb"', "must be one line"),
    "a long name": (sweep("", "two_pads") + f'name = "{300 * "z"}"', "has too many characters, 300 where at most 200 belong"),
    "an empty name": (sweep("", "two_pads") + 'name = ""', "has too few characters, 0 where at least 1 belong"),
    "a block's name of two lines": (sweep('vary = { "block[2].name" = ["b\\n"] }'), "must be one line"),
    "no values": (sweep('vary = { "joint.friction" = [] }'), "joint.friction = []: has too few entries"),
    "no path": (sweep('vary = { "joint friction" = [1.0] }'), '"joint friction": must be a dotted path'),
    "decimal comma": (sweep('vary = { "joint.friction" = [0,3, 0,6] }'), '"joint.friction" takes the value 0 twice; give it once'),
    "one value": (sweep('vary = { "joint.friction" = 0.3 }'), "sweep[0].vary.joint.friction = 0.3: must be an array; write [0.3]"),
    "a range in words": (sweep('vary = { "joint.friction" = "0.1:0.5" }'), "must be an array; list all values: [0.1, ..., 0.5]"),
    "a range with dots": (sweep('vary = { "joint.friction" = "0.1...0.5" }'), "must be an array; list all values: [0.1, ..., 0.5]"),
    "one value, without quotes": (sweep("vary = { joint.friction = 0.3 }"), "vary.joint.friction = 0.3: must be an array; write [0.3]"),
    "one value that is not a number": (sweep('vary = { "joint.friction" = nan }'), "vary.joint.friction = nan: must be an array"),
    "both with quotes and without": (
        sweep('vary = { joint.friction = [0.5], "joint.friction" = [0.6] }'),
        '"joint.friction" is given twice, with quotes and without',
    ),
    "one value together": (sweep('together = [{ "stone.density" = "x" }]'), "stone.density = 'x': must be an array; write [\"x\"]"),
    "decimal comma alone": (sweep('[sweep.set]\n"joint.friction" = 0,3'), "write numbers with a decimal point, 0.3"),
    "given twice": (sweep('set = { "joint.friction" = 1.0 }\nvary = { "joint.friction" = [1.0] }'), '"joint.friction" is given twice'),
    "unequal lengths": (sweep('together = [{ "joint.friction" = [1.0], "joint.inset" = [0.1, 0.2] }]'), "equally many values"),
    "too many": (
        sweep(f'vary = {{ "joint.friction" = {[0.01 * k for k in range(1, 102)]}, "joint.inset" = {[1e-5 * k for k in range(1, 101)]} }}'),
        f"at most {MOST_CASES} cases",
    ),
    "label of nothing": ('labels = { mu = "mu" }\n' + sweep(""), 'no sweep varies "mu"'),
    "one label for two keys": (
        "labels = { stone.density = 'x', joint.friction = 'x' }\n"
        + sweep('vary = { "joint.friction" = [0.5], "stone.density" = [2000.0, 2200.0] }'),
        'labels = \'x\': "stone.density" and "joint.friction" have the same label; give each key its own',
    ),
    "unknown key of the scene": (sweep('vary = { "joint.frction" = [0.5] }'), 'joint.frction: unknown key; did you mean "friction"?'),
    "wrong value for the scene": (sweep('vary = { "joint.friction" = [0.5, -1.0] }'), "joint.friction = -1.0: must"),
    "impossible structure": (sweep('set = { "block[2].box.to[0]" = -1.0 }'), "every coordinate of `to` must be greater"),
    "index beyond": (sweep('set = { "block[3].density" = 1.0 }'), "block has 3 entries; [0] is the first"),
    "index beyond the only one": (sweep('set = { "wall[1].courses" = 3 }', "wall_third"), "wall has 1 entry; [0] is the first"),
    "index missing": (sweep('set = { "block.density" = 1.0 }'), "block is an array; select one of its entries: block[0].density"),
    "index of a table": (sweep('set = { "joint[0]" = 1.0 }'), "joint is not an array"),
    "below a value": (sweep('set = { "joint.friction.x" = 1.0 }'), "joint.friction is a value, not a table"),
    "an array that is not there": (sweep('set = { "wall[0].courses" = 3 }'), "the scene has no wall"),
    "unknown parameter": (sweep('vary = { "classic.slop" = [0.1] }'), 'classic.slop: unknown key; did you mean "slope"?'),
    "wrong kind of parameter": (sweep('vary = { "classic.iterations" = [0.5] }'), "classic.iterations = 0.5: must be a whole number"),
    "impossible parameter": (
        sweep('vary = { "classic.relaxation" = [nan] }'),
        "two_pads_relaxation=nan: classic: needs relaxation in (0, 1], slope from 0, iterations from 1, "
        "and cohesion from 0 and below tolerance; given: relaxation = nan; the others have their defaults",
    ),
    "parameter beyond all numbers": (sweep(f'vary = {{ "classic.slope" = [1{"0" * 400}] }}'), "classic: needs relaxation in (0, 1]"),
    "impossible model": (sweep('vary = { "effects.plane" = [true] }', "slab_four_corners"), "effects.plane = true: "),
}


@pytest.mark.parametrize(("text", "words"), WRONG.values(), ids=WRONG)
def test_a_wrong_file_is_refused_in_one_message_before_anything_runs(
    text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, text)
    assert main(["campaign", str(path), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith(f"error: {path}: ") and said.err.count("error: ") == 1
    assert words in " ".join(said.err.split())
    assert not (tmp_path / "out").exists()


def test_a_wrong_case_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, sweep('vary = { "joint.friction" = [0.5, -1.0] }'))
    with pytest.raises(SceneError, match=r"campaign\.toml: case two_pads_friction=-1\.0: joint\.friction = -1\.0: must be"):
        expand(load_campaign(path))


def test_a_campaign_that_cannot_be_read_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in (tmp_path, tmp_path / "nowhere.toml"):
        assert main(["campaign", str(path)]) == 2
        assert str(path) in capsys.readouterr().err


def names(text: str, tmp_path: Path) -> list[str]:
    return [case.name for case in expand(load_campaign(written(tmp_path, text)))]


def test_cases_are_the_product_in_the_order_of_the_file_the_last_key_fastest(tmp_path: Path) -> None:
    together = 'together = [{ "block[0].box.to[0]" = [0.4, 0.45], "block[1].box.from[0]" = [0.5, 0.55] }]'
    text = sweep(f'vary = {{ "joint.friction" = [0.3, 0.6] }}\n{together}') + 'labels = { "joint.friction" = "mu" }'
    text = 'labels = { "joint.friction" = "mu" }\n' + text.removesuffix('labels = { "joint.friction" = "mu" }')
    found = expand(load_campaign(written(tmp_path, text)))
    assert [case.name for case in found] == [
        "two_pads_mu=0.3_to0=0.4", "two_pads_mu=0.3_to0=0.45", "two_pads_mu=0.6_to0=0.4", "two_pads_mu=0.6_to0=0.45",
    ]  # fmt: skip
    keys = ("joint.friction", "block[0].box.to[0]", "block[1].box.from[0]")
    assert [tuple(case.values[key] for key in keys) for case in found] == [
        (0.3, 0.4, 0.5), (0.3, 0.45, 0.55), (0.6, 0.4, 0.5), (0.6, 0.45, 0.55),
    ]  # fmt: skip
    scene = found[1].run.scene()
    assert scene.friction == 0.3 and scene.title.endswith(": mu = 0.3, to0 = 0.45")
    assert scene.blocks.vertices[: scene.blocks.vertex_start[1], 0].max() == 0.45


def test_keys_may_be_written_with_and_without_quotes(tmp_path: Path) -> None:
    quoted = 'labels = { "joint.friction" = "mu" }\n' + sweep(
        'vary = { "joint.friction" = [0.3, 0.6] }\ntogether = [{ "stone.density" = [1.0] }]'
    )
    plain = "labels.joint.friction = 'mu'\n" + sweep("vary.joint.friction = [0.3, 0.6]\ntogether = [{ stone.density = [1.0] }]")
    assert names(plain, tmp_path) == names(quoted, tmp_path) == ["two_pads_mu=0.3_density=1.0", "two_pads_mu=0.6_density=1.0"]


def test_the_tables_hold_the_names_of_scenes_and_sweeps_as_they_are_written(tmp_path: Path, plain_figures: None) -> None:
    (tmp_path / "my scene #1%.toml").write_text(find("two_pads").read_text())
    text = sweep("", "my scene #1%") + '[[sweep]]\nscene = "my scene #1%"\nname = "bogen é $x$"\nset = { "joint.friction" = 0.3 }\n'
    found = run(text, tmp_path / "out")
    assert [(row["scene"], row["sweep"]) for row in found.rows] == [("my scene #1%", "my scene #1%"), ("my scene #1%", "bogen é $x$")]
    assert [(row["case"], row["folder"]) for row in found.rows] == [("myscene1", "cases/myscene1"), ("bogenx", "cases/bogenx")]
    page = write_campaign_report(found).read_text(encoding="utf-8")
    assert "bogen é $x$" in page
    older = replace(
        found, rows=[row | {"scene": "myscene1", "sweep": safe} for row, safe in zip(found.rows, ("myscene1", "bogenx"), strict=True)]
    )
    assert not compare_tables(older, found).changed


def test_names_are_unique_short_and_lead_nowhere(tmp_path: Path) -> None:
    odd = '"../../x", "..", "a/b", "$(x)", "A", "a", "%2e%2e/", "é", "", ".", "' + "z" * 300 + '", "' + "z" * 299 + '"'
    found = names(sweep(f'vary = {{ "source" = [{odd}] }}\nname = "../{"n" * 30}"'), tmp_path)
    assert len({name.casefold() for name in found}) == len(found) == 12
    for name in found:
        assert Path(name).name == name and len(name) <= LONGEST + 4 and name.startswith("n" * 30 + "_source=")
        assert not set(name) & set("/\\$()*?[]{}<>|&;:'\" ,")


def test_equal_cases_of_two_sweeps_share_a_run_and_each_row_has_every_value_that_its_scene_has(tmp_path: Path) -> None:
    text = sweep('vary = { "joint.friction" = [0.3, 0.6, 0.6] }')
    text += '[[sweep]]\nscene = "two_pads"\nvary = { "joint.inset" = [0.001, 0.002] }'
    definition = load_campaign(written(tmp_path, text))
    found = expand(definition)
    assert [case.name for case in found] == [f"two_pads_{key}" for key in ("friction=0.3", "friction=0.6", "inset=0.001", "inset=0.002")]
    assert [case.sweep for case in found] == ["two_pads", "two_pads", "two_pads-2", "two_pads-2"]
    assert found[1].run is found[2].run and len({case.run.name for case in found}) == 3
    assert [list(case.values.values()) for case in found] == [[0.3, 0.001], [0.6, 0.001], [0.6, 0.001], [0.6, 0.002]]  # the scene's values
    assert axes(definition, found) == {"joint.friction": [0.3, 0.6], "joint.inset": [0.001, 0.002]}


def test_scenes_of_one_name_in_two_folders_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    """The cases of students of one class were once named pads, pads-2 and pads-3: nobody knew whose they were."""
    for owner in ("anna", "bernd"):
        (tmp_path / owner).mkdir()
        (tmp_path / owner / "pads.toml").write_text(find("two_pads").read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "arch.toml").write_text(find("two_pads").read_text(encoding="utf-8"), encoding="utf-8")
    text = "".join(f'[[sweep]]\nscene = "{scene}"\n' for scene in ("anna/pads.toml", "bernd/pads.toml", "anna/pads", "arch"))
    found = expand(load_campaign(written(tmp_path, text)))
    assert [case.sweep for case in found] == ["anna_pads", "bernd_pads", "anna_pads-2", "arch"]
    assert [case.name for case in found] == ["anna_pads", "bernd_pads", "anna_pads-2", "arch"]


def test_an_expected_value_that_a_campaign_sets_stays_where_it_equals_the_scene_s_own(tmp_path: Path) -> None:
    text = sweep('[sweep.vary]\n"expected.reaction_over_weight" = [0.1666666667, 0.2]\n"joint.friction" = [0.1, 0.3]')
    expected = [case.run.scene().expected for case in expand(load_campaign(written(tmp_path, text)))]
    assert [one and one.reaction_over_weight for one in expected] == [0.1666666667, 0.1666666667, 0.2, 0.2]


def test_an_expected_value_holds_for_the_scene_as_it_is_alone(tmp_path: Path) -> None:
    settings = ['"yade.time_limit" = 60.0', '"joint.friction" = 0.5', '"joint.friction" = 0.5\n"expected.tolerance" = 0.1']
    kept = []
    for setting in settings:
        text = sweep(f"[sweep.set]\n{setting}")
        if "expected" in setting:
            text += '"expected.reaction_over_weight" = 0.16667\n"expected.kind" = "exact"\n'
        (case,) = expand(load_campaign(written(tmp_path, text)))
        kept.append(case.run.scene().expected is not None)
    assert kept == [True, False, True]


def test_a_scene_lies_beside_the_campaign_and_its_meshes_beside_the_scene(tmp_path: Path, plain_figures: None) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    for name in ("rubble_wall.toml", "rubble_wall.obj"):
        (folder / name).write_bytes((find("rubble_wall").parent / name).read_bytes())
    text = sweep('vary = { "joint.friction" = [0.5] }', "scenes/rubble_wall.toml")
    (row,) = run(text, tmp_path / "out").rows
    assert row["state"] == "done" and row["coulomb_status"] == "solved"
    scene = load_scene(folder / "rubble_wall.toml")
    assert row["weight"] == scene.weight


def test_a_shipped_campaign_is_found_by_its_name_and_all_its_cases_are_scenes(capsys: pytest.CaptureFixture[str]) -> None:
    cases = expand(load_campaign(find_campaign(Path("seed_paper"))))
    assert len(cases) >= 60 and len({case.sweep for case in cases}) == 9
    assert main(["campaign", "seed_papers"]) == 2
    assert 'did you mean "seed_paper"?' in capsys.readouterr().err
    assert main(["campaign", "unlike"]) == 2
    assert "valid campaigns: seed_paper" in capsys.readouterr().err


def test_what_cannot_be_read_as_a_campaign_ends_with_a_next_step(tmp_path: Path) -> None:
    latin = tmp_path / "latin.toml"
    latin.write_bytes(b'title = "M\xfcnster"')
    for path, words in ((tmp_path / "none.toml", "seed_paper"), (tmp_path, "name the campaign file itself"), (latin, "the encoding UTF-8")):
        with pytest.raises(SceneError, match=words):
            load_campaign(path)


@pytest.mark.parametrize("label", ["μ", "tan φ", "Höhe"])
def test_a_label_with_letters_that_folders_leave_out_is_replaced_by_its_key(label: str, tmp_path: Path) -> None:
    """Cases with two Greek labels were told apart by their values alone, as `two_pads_=0.3`."""
    text = f'labels = {{ "joint.friction" = "{label}" }}\n' + sweep('vary = { "joint.friction" = [0.3, 0.6] }')
    assert names(text, tmp_path) == ["two_pads_joint.friction=0.3", "two_pads_joint.friction=0.6"]


def test_a_label_of_ascii_letters_names_the_cases_without_its_blanks(tmp_path: Path) -> None:
    text = 'labels = { "joint.friction" = "tan phi (-)" }\n' + sweep('vary = { "joint.friction" = [0.3] }')
    assert names(text, tmp_path) == ["two_pads_tanphi-=0.3"]
