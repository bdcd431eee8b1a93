"""`crosscheck sensitivity` tabulates and draws the influence of the classic iteration's parameters on its answer."""

import json
from pathlib import Path

import pytest

from comparison.cli.commands import main


def test_the_classic_iteration_s_sensitivity_is_tabled_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figure = tmp_path / "sensitivity.png"
    assert main(["sensitivity", "two_blocks", "-o", str(figure), "--json"]) == 0
    study = json.loads(capsys.readouterr().out)
    assert len(study["trials"]) == 25 and figure.stat().st_size > 10_000
