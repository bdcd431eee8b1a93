"""`crosscheck solve --bounds` ends with the bounds: it makes no prediction, and judges only expected values of bounds."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import pytest
from printed_tables import names_in

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, INCONCLUSIVE, USAGE
from la_core.analysis import one_pass
from la_core.limit import Drive, Status
from la_core.scene import load, shipped, variant


@pytest.fixture
def nothing_predicted(monkeypatch: pytest.MonkeyPatch) -> None:
    def predicted(*arguments: object) -> None:
        raise AssertionError("a prediction was begun")

    monkeypatch.setattr(one_pass, "with_prediction", predicted)


def summary(capsys: pytest.CaptureFixture[str], *command: str) -> dict[str, Any]:
    assert main(["solve", *command, "--json"]) == AGREE
    return dict(json.loads(capsys.readouterr().out))


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_end_without_a_prediction(capsys: pytest.CaptureFixture[str]) -> None:
    answer = summary(capsys, "two_pads", "--bounds")
    assert answer["limit_analysis"]["coulomb"] is None and answer["limit_analysis"]["path"] is None
    assert answer["limit_analysis"]["associated"]["reaction"] == pytest.approx(363.297, abs=1e-3)
    assert answer["effects"]["reasons"]["friction"] == "only the bounds were requested"
    assert main(["solve", "two_pads", "--bounds", "-q"]) == AGREE
    printed = capsys.readouterr().out
    assert names_in(printed).count("reaction") == 1 and "Coulomb" not in printed


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_are_printed_for_a_scene_with_an_accuracy(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pads.toml"
    path.write_text(f"accuracy = 0.002\n{shipped.find('two_pads').read_text()}")
    assert main(["solve", str(path), "--bounds"]) == AGREE
    captured = capsys.readouterr()
    assert names_in(captured.out).count("reaction") == 1 and "bounds:" not in captured.err


@pytest.mark.usefixtures("nothing_predicted")
@pytest.mark.parametrize(
    ("name", "judged"),
    [
        ("two_pads", ["expected greatest reaction"]),
        ("wall_low_friction", []),
        ("ferris_tin_loi_1", ["expected associated multiplier"]),
    ],
)
def test_bounds_alone_are_held_against_what_is_expected_of_bounds(name: str, judged: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", name, "--bounds", "-q"]) == AGREE
    assert [row for row in names_in(capsys.readouterr().out) if row.startswith("expected")] == judged


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_of_a_law_of_bounds_are_held_against_its_expected_value(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pads.toml"
    path.write_text(shipped.find("two_pads").read_text() + '\n[effects]\nfriction = "associated"\n')
    assert main(["solve", str(path), "--bounds", "-q"]) == AGREE
    assert "expected reaction" in names_in(capsys.readouterr().out)


@pytest.mark.usefixtures("nothing_predicted")
@pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING])
def test_the_status_of_every_bound_decides_the_exit_code(drive: Drive, monkeypatch: pytest.MonkeyPatch) -> None:
    original = one_pass.solve_associated

    def inaccurate(assembly, asked, problem, near):
        solution = original(assembly, asked, problem, near=near)
        return dataclasses.replace(solution, status=Status.INACCURATE) if asked is drive else solution

    monkeypatch.setattr(one_pass, "solve_associated", inaccurate)
    assert main(["solve", "two_pads", "--bounds", "-q"]) == INCONCLUSIVE


def test_bounds_alone_and_a_path_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["solve", "two_pads", "--bounds", "--path"])
    assert stop.value.code == USAGE and "not allowed with" in capsys.readouterr().err


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_and_an_accuracy_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pads", "--bounds", "--accuracy", "0.1%"]) == USAGE
    captured = capsys.readouterr()
    assert "not allowed with argument --bounds" in captured.err and "leave out --bounds" in captured.err
    assert captured.out == "" and captured.err.count("\n") == 1


def test_bounds_alone_can_be_drawn(tmp_path: Path) -> None:
    assert main(["solve", "two_pads", "--bounds", "-q", "-o", str(tmp_path / "bounds.png")]) == AGREE
    assert (tmp_path / "bounds.png").read_bytes().startswith(b"\x89PNG")


def test_a_variant_without_a_prediction_prints_one_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = variant(load("two_pads"), {"expected": None, "effects.friction": "associated"})
    path = tmp_path / "bound.toml"
    path.write_text(scene.text)
    assert main(["solve", str(path), "-q"]) == AGREE
    assert capsys.readouterr().out.count("over W") == 1
