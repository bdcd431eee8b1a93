"""The interactive view receives the results of both methods, and the page admits its own scripts and nothing else."""

import base64
import hashlib
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from conftest import CrossChecked
from runs import TRAVEL, perfect_run, with_answers
from scenes import base, block, box, build, load, shipped, table

from comparison.figures.canvas import structure_size
from comparison.figures.motion import DRAWN, motions
from comparison.report import viewer
from comparison.report.report import write_report
from comparison.yade import Results
from la_core.analysis.stage import analyse
from la_core.limit import Drive
from la_core.measures import joint_forces
from la_core.scene import GROUND

SINGLE = 1e-6  # relative round-off of the page's 32-bit numbers
HOSTILE = "</script><script>alert(1)</script><!-- <b> ]]> {{ 7 * 7 }} \u2028"
ELEMENT = re.compile(r"<script([^>]*)>(.*?)</script>", re.DOTALL)


def array(text: str, dtype: str, *shape: int) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype).reshape(shape)


def data_of(found: CrossChecked) -> dict[str, Any]:
    return dict(json.loads(viewer.viewer_text(Results(found.analysis, found.run))))


def test_the_triangles_enclose_each_block() -> None:
    scene = shipped("arch_spreading")
    analysis = analyse(scene)
    data, blocks = json.loads(viewer.viewer_text(Results(analysis))), analysis.assembly.blocks
    vertices = array(data["vertices"], "<f4", -1, 3).astype(float)
    triangles, owner = array(data["triangles"], "<u4", -1, 3), array(data["owner"], "<u4", -1)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    volume = np.bincount(owner[triangles[:, 0]], weights=np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0)
    assert volume == pytest.approx(blocks.volume, rel=100.0 * SINGLE)
    edges = array(data["edges"], "<u4", -1, 2)
    assert np.all(owner[edges[:, 0]] == owner[edges[:, 1]])
    # Euler's formula: for every block, vertices less edges plus faces are 2.
    assert len(vertices) - len(edges) + len(blocks.face_block) == 2 * len(blocks)


def test_yade_moves_as_it_recorded_from_rest_and_limit_analysis_by_its_mechanism(cross_checked: Callable[[str], CrossChecked]) -> None:
    found = cross_checked("two_pads")
    data, run, blocks = data_of(found), found.run, len(found.analysis.assembly.blocks)
    limit_analysis, yade = data["methods"]
    shown, recorded = array(yade["settlement"], "<f4", -1), run.poses.settlement
    kept = np.flatnonzero(np.isin(recorded.astype("<f4"), shown))  # of many stored states only some are shown
    assert len(kept) == len(shown) == min(len(recorded), viewer.MOST_STATES) and kept[0] == 0 and kept[-1] == len(recorded) - 1
    moved = array(yade["displacement"], "<f4", -1, blocks, 6)
    poses = np.concatenate([run.poses.displacement, run.poses.rotation], axis=2)
    assert moved == pytest.approx(poses[kept] - poses[0], rel=SINGLE, abs=SINGLE * np.abs(poses).max())
    resultants = np.stack([joint_forces(found.analysis.assembly, forces).force for forces in run.poses.forces[kept]])
    assert array(yade["forces"], "<f4", len(moved), -1, 3) == pytest.approx(resultants, rel=SINGLE, abs=1e-3)
    assert data["names"] == list(found.analysis.assembly.blocks.names) and data["force_unit"] == "kN"
    assert found.analysis.coulomb is not None
    last = array(limit_analysis["displacement"], "<f4", 2, blocks, 6)[1]
    assert last == pytest.approx(data["end"] * found.analysis.coulomb.twists, rel=SINGLE, abs=1e-12)
    assert data["end"] == run.poses.settlement[-1]


def test_the_fastest_point_is_drawn_to_move_a_fixed_share_of_the_size(two_pads: str) -> None:
    analysis = analyse(load(two_pads))
    shown, blocks = motions(Results(analysis)), analysis.assembly.blocks
    (method,) = shown.methods
    moved = shown.magnification * method.at(shown.end)
    owner = np.repeat(np.arange(len(blocks)), np.diff(blocks.vertex_start))
    speed = np.linalg.norm(moved[owner, :3] + np.cross(moved[owner, 3:], blocks.vertices - blocks.centroid[owner]), axis=1)
    assert speed.max() == pytest.approx(DRAWN * structure_size(blocks))
    assert not np.any(method.at(0.0))
    assert method.at(0.25 * shown.end) == pytest.approx(0.25 * method.at(shown.end))


def test_a_collapse_stays_in_the_picture(cross_checked: Callable[[str], CrossChecked]) -> None:
    found = cross_checked("two_pads")
    blocks = found.analysis.assembly.blocks
    (free,) = np.flatnonzero(blocks.free)
    for fall, drawn in ((0.01, 0.5 * structure_size(blocks)), (3.0, 3.0)):  # m
        displacement = found.run.poses.displacement.copy()
        displacement[-1, free, 2] -= fall
        result = replace(found.run.result, plateau_start=np.nan)
        run = replace(found.run, result=result, poses=replace(found.run.poses, displacement=displacement))
        shown = motions(Results(found.analysis, run))
        moved = shown.magnification * shown.methods[1].at(shown.end)[free]
        assert np.linalg.norm(moved[:3]) == pytest.approx(drawn, rel=0.05)  # its corners move a little more


def test_large_states_are_fewer_and_the_first_and_last_are_kept(
    cross_checked: Callable[[str], CrossChecked], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = cross_checked("two_pads")
    assembly = found.analysis.assembly
    each = 4 * (6 * len(assembly.blocks) + 6 * len(assembly.interfaces))
    for count in (2, 5):
        monkeypatch.setattr(viewer, "LARGEST", count * each)
        settlement = array(data_of(found)["methods"][1]["settlement"], "<f4", -1)
        assert len(settlement) == count
        assert settlement[[0, -1]] == pytest.approx(found.run.poses.settlement[[0, -1]], rel=SINGLE)


def test_what_cannot_stand_is_shown_at_rest_with_its_reason(two_pads: str) -> None:
    scene = load(
        two_pads.replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]").replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]")
    )
    data = json.loads(viewer.viewer_text(Results(analyse(scene))))
    (method,) = data["methods"]
    assert (data["start"], data["end"], method["note"]) == (0.0, 0.0, "cannot stand")
    assert not np.any(array(method["displacement"], "<f4", -1)) and not np.any(array(method["forces"], "<f4", -1))
    assert data["palette"][array(method["looks"], "u1", -1)[2]]["name"].startswith("falls")
    assert np.all(array(method["joints"], "i1", -1) == -1)


LOADED = (
    box("ground", (0.0, 0.0, -0.2), (2.0, 0.5, 0.0), "fixed"),
    box("stone", (0.5, 0.0, 0.0), (1.5, 0.5, 1.0)),
    table("[load]", name="floor", blocks=["stone"], per="m2", mass=200.0),
    table("[load]", name=HOSTILE, blocks=["stone"], force=(500.0, 0.0, 0.0), at=(0.5, 0.25, 0.5)),
    table("[tie]", name="rod", blocks=["stone"], **{"from": (0.5, 0.25, 0.8), "to": (0.0, 0.25, 0.0), "force": 300.0}),
)


@pytest.mark.parametrize(("drive", "push"), [({"live": (-1.0, 0.0, 0.0)}, "live load"), ({"tilt": (0.0, -1.0, 0.0)}, "push of the tilt")])
def test_loads_stand_where_they_act_and_go_with_their_blocks(drive: dict[str, Any], push: str) -> None:
    parts = LOADED if "live" in drive else LOADED[:3]
    scene = build(*parts, **drive)
    data = json.loads(viewer.viewer_text(Results(analyse(scene))))
    middle, stone = np.array([1.0, 0.25, 0.4]), scene.blocks.names.index("stone")
    loads = {load["kind"] + load["words"].partition(":")[0]: load for load in data["loads"]}
    ends = {name: [array(load[k], "<f4", -1, 3) + middle for k in ("start", "end")] for name, load in loads.items()}
    of = {name: [array(load[k], "<i4", -1).tolist() for k in ("of_start", "of_end")] for name, load in loads.items()}
    assert loads["deadfloor"]["words"] == "floor: 0.981 kN"
    assert ends["deadfloor"][1] == pytest.approx(np.array([[1.0, 0.25, 1.0]]), abs=1e-6)
    assert np.diff(ends["deadfloor"], axis=0)[0, 0] / structure_size(scene.blocks) == pytest.approx([0.0, 0.0, -0.08], abs=1e-6)
    assert of["deadfloor"] == [[stone], [stone]]
    start, end = ends[f"push{push}"]
    assert (end - start)[0] == pytest.approx([-0.2 * structure_size(scene.blocks), 0.0, 0.0], abs=1e-6)
    assert of[f"push{push}"] == [[GROUND], [GROUND]]
    if "live" not in drive:
        assert set(loads) == {"deadfloor", f"push{push}"}
        return
    assert ends["tierod"][0] == pytest.approx(np.array([[0.5, 0.25, 0.8]]), abs=1e-6) and of["tierod"] == [[stone], [GROUND]]
    assert loads["tierod"]["words"] == "rod: 0.300 kN" and len(data["loads"]) == 4


def test_a_scene_without_loads_shows_none_and_a_settlement_is_no_push(two_pads: str) -> None:
    assert json.loads(viewer.viewer_text(Results(analyse(load(two_pads)))))["loads"] == []


def test_the_motion_of_a_pushed_structure_is_enlarged_where_a_run_gives_it_a_size() -> None:
    analysis = analyse(build(*LOADED, live=(1.0, 0.0, 0.0)))
    run = perfect_run(with_answers(analysis, bounds={**analysis.bounds, Drive.YIELDING: analysis.bounds[Drive.LIVE]}))
    for results, end in ((Results(analysis), None), (Results(analysis, run), TRAVEL)):
        data, shown = json.loads(viewer.viewer_text(results)), motions(results)
        assert (data["quantity"], data["unit"]) == ("growth of the mechanism", "%")
        assert data["end"] * data["unit_per_si"] == pytest.approx(100.0)
        assert data["magnification"] == (None if end is None else shown.magnification)
        assert end is None or (data["end"] == end and data["magnification"] > 10.0)


def page_of(folder: Path, *texts: str) -> str:
    """Return the page of a report with one scene for each view, "" for a scene without a view."""
    for number, text in enumerate(texts):
        (folder / f"scene{number}").mkdir()
        if text:
            (folder / f"scene{number}" / viewer.FILE).write_text(text, encoding="utf-8")
    comparisons = [{"scene": f"scene{number}", "verdict": None} for number in range(len(texts))]
    return write_report(folder, comparisons, {}).read_text(encoding="utf-8")


def test_the_page_runs_its_own_scripts_and_no_other(tmp_path: Path) -> None:
    page = page_of(tmp_path, json.dumps({"title": HOSTILE}), json.dumps({"title": HOSTILE}))
    elements = ELEMENT.findall(page)
    views, (library, script) = elements[:-2], [text for _, text in elements[-2:]]
    assert len(views) == 2 and page.count("<script") == 4 and "alert(1)</" not in page  # one library, however many scenes
    assert all('type="application/json"' in attributes and json.loads(text) == {"title": HOSTILE} for attributes, text in views)
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', page)
    digests = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'" for text in (library, script))
    assert (
        policy == f"default-src 'none'; base-uri 'none'; form-action 'none'; style-src 'unsafe-inline'; img-src data:; script-src {digests}"
    )
    assert (viewer.WEB / "three.LICENSE").read_text(encoding="utf-8").strip() in library
    for text in (library, script):
        assert "<!--" not in text and not re.search(r"\beval\(|new Function|innerHTML", text)


def test_without_a_view_the_page_has_no_script(tmp_path: Path) -> None:
    page = page_of(tmp_path, "", "{ broken", "[" * 100_000)
    assert "<script" not in page and "script-src" not in page and "viewer-data" not in page


def test_the_page_of_a_small_scene_stays_small(cross_checked: Callable[[str], CrossChecked], tmp_path: Path) -> None:
    found = cross_checked("two_pads")
    page = page_of(tmp_path, viewer.viewer_text(Results(found.analysis, found.run)))
    assert len(page) < 0.7e6  # the library is 0.57 MB of it
    assert "The view needs scripts and WebGL; the figures below show the same without." in page


def test_the_edges_of_a_stone_of_several_parts_are_those_of_its_outside() -> None:
    channel = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
    analysis = analyse(build(*base(1.5, 3.0), block("channel", prism=(channel, [0.1, 0.8]))))
    data, blocks = json.loads(viewer.viewer_text(Results(analysis))), analysis.assembly.blocks
    ends = blocks.vertices[array(data["edges"], "<u4", -1, 2)]
    front = [shapely.LineString(edge[:, [0, 2]]) for edge in ends if np.all(edge[:, 1] == 0.1)]
    assert shapely.union_all(front).symmetric_difference(shapely.Polygon(channel).exterior).length < SINGLE
    back = {tuple(edge[0, [0, 2]].tolist()) for edge in ends if sorted(edge[:, 1]) == [0.1, 0.8]}
    assert back == {tuple(corner) for corner in channel}
