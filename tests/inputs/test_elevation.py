"""An elevation written by a drawing program is taken from the file to the bounds, without code of the user's and with one flag."""

import json
from pathlib import Path

import pytest
from elevations import Window, elevation

from comparison.cli.commands import main

WINDOWS = tuple(Window(x, sill) for sill in (1000.0, 4600.0) for x in (1600.0, 6000.0, 10400.0))


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    capsys.readouterr()
    assert main([*arguments, "--json", "-q"]) == 0
    return json.loads(capsys.readouterr().out)


def taken_through(path: Path, content: bytes, capsys: pytest.CaptureFixture[str]) -> tuple[dict, dict]:
    """Output of `show` and of `solve --bounds` for a drawing after `new --from`."""
    path.write_bytes(content)
    scene = str(path.with_suffix(".toml"))
    assert main(["new", "-q", "--from", str(path)]) == 0
    shown = printed(capsys, "show", scene, "-o", str(path.with_suffix(".png")))
    return shown, printed(capsys, "solve", scene, "--bounds")


def is_whole(shown: dict, blocks: int) -> None:
    """Check that every brick is present once and that its joints are closed, except at the cut bricks over the arches."""
    (drawing,), repairs = shown["geometry"]["drawings"], shown["geometry"]["repairs"]
    assert shown["free_blocks"] >= blocks and shown["fixed_blocks"] == shown["support_blocks"] == 1
    assert drawing["doubles"] > 0 and drawing["loose_lines"] == 0 and drawing["ignored"] == {"TEXT": 1}
    assert repairs["gaps_closed"] > 2.3 * blocks  # about three joints a brick, less at edges and openings
    assert len(repairs["unclosed"]) < 0.05 * shown["free_blocks"]
    assert repairs["largest_move"] < 0.05


@pytest.mark.slow
def test_a_window_in_a_wall(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown, solved = taken_through(tmp_path / "wall.dxf", elevation(8, 14, (Window(1000.0, 600.0),)), capsys)
    is_whole(shown, 100)
    assert solved["limit_analysis"]["associated"]["status"] == "solved"


@pytest.mark.slow
def test_a_facade_of_sixteen_hundred_blocks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown, solved = taken_through(tmp_path / "facade.dxf", elevation(34, 48, WINDOWS), capsys)
    is_whole(shown, 1500)
    associated = solved["limit_analysis"]["associated"]
    assert associated["status"] == "solved"
    assert 0.0 < associated["reaction"] < associated["reaction_max"] < shown["weight"]
