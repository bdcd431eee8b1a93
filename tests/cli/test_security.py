"""Files of other authors are only data: no process listens on a port, no file outside of a folder is touched, and sizes are bounded."""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import scenes
from processes import listening, tree

from comparison.cli.commands import main
from la_core import exchange
from la_core.errors import SceneError
from la_core.exchange import checksummed_file
from la_core.scene import reading, scene
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find

ROOT = Path(__file__).parents[2]


# --- listening processes ------------------------------------------------------------------------------------------------------


def test_what_listens_is_seen() -> None:
    """A process that listens on a port is seen, so the next test could fail."""
    program = "import socket, time; s = socket.create_server(('127.0.0.1', 0)); print(1, flush=True); time.sleep(60)"
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stdout.readline()
        assert len(listening(tree(os.getpid()))) == 1
        process.kill()


@pytest.mark.slow
@pytest.mark.yade
def test_nothing_listens_during_a_run(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "comparison", "run", "two_pads", "-o", str(tmp_path / "out"), "-q"]
    seen, most = set(), 0
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL) as process:
        while process.poll() is None:
            processes = tree(process.pid)
            most = max(most, len(processes))
            seen |= listening(processes)
            time.sleep(0.02)
    assert process.returncode == 0
    assert most >= 2  # YADE's process was among them
    assert not seen


# --- programs -----------------------------------------------------------------------------------------------------------------


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    "words",
    [
        ("run", "two_pads", "slab_four_corners", "--no-yade", "--workers", "2", "-o", "out"),
        pytest.param(("doctor",), marks=pytest.mark.yade),
    ],
)
def test_no_program_of_the_current_folder_is_run(words: tuple[str, ...], tmp_path: Path) -> None:
    """A folder of scenes may come from anybody, and Python loads modules from the current folder unless this is forbidden."""
    for name in ("signal", "pickle", "multiprocessing", "numpy", "h5py"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('loaded from the current folder')\n", encoding="utf-8")
    command = tmp_path / "bin" / "crosscheck"  # as pip writes it
    command.parent.mkdir()
    command.write_text(
        "import sys\nfrom comparison.__main__ import main\nif __name__ == '__main__':\n    sys.exit(main())\n", encoding="utf-8"
    )
    ended = subprocess.run(
        [sys.executable, command, *words],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    assert "loaded from the current folder" not in ended.stdout + ended.stderr


# --- files --------------------------------------------------------------------------------------------------------------------


def test_a_scene_s_name_is_a_name_and_no_path(tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("...toml", "report.html.toml"):
        (tmp_path / name).write_text(two_pads)
        assert main(["run", str(tmp_path / name), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
        assert "cannot name a folder of results" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.yade
def test_links_in_the_place_of_results_are_replaced_and_not_followed(tmp_path: Path) -> None:
    victim, out = tmp_path / "victim", tmp_path / "out"
    victim.write_text("untouched")
    (out / "two_pads").mkdir(parents=True)
    names = ("scene.toml", "case.h5", "run.h5", "comparison.json", "yade.log", "assembly.png", "viewer.json", ".lock")
    for name in names:
        (out / "two_pads" / name).symlink_to(victim)
    for name in ("report.html", "report.md", "report.json"):
        (out / name).symlink_to(victim)
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    assert victim.read_text() == "untouched"


def test_meshes_are_not_copied_through_a_link(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, elsewhere = tmp_path / "out" / "wall", tmp_path / "elsewhere"
    out.mkdir(parents=True)
    elsewhere.mkdir()
    (out / "stones").symlink_to(elsewhere)
    (tmp_path / "stones").mkdir()
    shutil.copy(scenes.SHIPPED / "rubble_wall.obj", tmp_path / "stones")
    text = (scenes.SHIPPED / "rubble_wall.toml").read_text()
    assert '"rubble_wall.obj"' in text
    (tmp_path / "wall.toml").write_text(text.replace('"rubble_wall.obj"', '"stones/rubble_wall.obj"'))
    assert main(["run", str(tmp_path / "wall.toml"), "-o", str(tmp_path / "out"), "--no-yade", "-q"]) == 2
    assert "through a link" in capsys.readouterr().err
    assert not list(elsewhere.iterdir())


def test_a_scene_that_is_no_file_is_not_waited_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "zero.toml").symlink_to("/dev/zero")
    for name in ("pipe.toml", "zero.toml"):
        assert main(["solve", str(tmp_path / name)]) == 2
        assert "reading it might never end" in capsys.readouterr().err


# --- sizes --------------------------------------------------------------------------------------------------------------------


def test_a_scene_s_text_and_blocks_are_limited(tmp_path: Path, two_pads: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(two_pads + "".join(f'\n[[wall]]\nname = "{k}"\nbond = "stack"\n{WALL}' for k in range(3)))
    with monkeypatch.context() as patch:
        patch.setattr(scene, "MOST_BLOCKS", 20)
        with pytest.raises(SceneError, match="has more than 20 blocks; use fewer or larger blocks"):
            load_scene(path)
    monkeypatch.setattr(reading, "LARGEST_FILE", 100)
    with pytest.raises(SceneError, match="larger than 100 bytes"):
        load_scene(path)


WALL = "origin = [5.0, 0.0, 0.0]\nblock = [0.4, 0.2, 0.2]\nper_course = 3\ncourses = 3\n"


SLOW: dict[str, Callable[[int], str]] = {  # lines of a given length
    "signs": lambda count: "x = " + "=" * count,
    "braces": lambda count: "x = " + "{" * count + "}",
    "a deep key": lambda count: "a." * count + "b = 1",
    "a deep table": lambda count: "[" + "a." * count + "b]",
    "a deep key in quotes": lambda count: '"a \\" b".' * count + "b = 1",
    "a deep key in braces": lambda count: "x = { " + "a." * count + "b = 1 }",
}
LONG_LINE = 50_000
GROWTH, NOISE = 3.0, 0.1  # seconds for a line twice as long, over those for the line (the square takes 4 times as many); s of other work


def seconds_to_refuse(text: str, path: Path) -> float:
    """Return the least processor time of three, s. Other processes of a busy machine add nothing to it."""
    path.write_text(text)
    spent = []
    for _ in range(3):
        begin = time.process_time()
        with pytest.raises(SceneError) as error:
            load_scene(path)
        spent.append(time.process_time() - begin)
        assert len(str(error.value)) < 300
    return min(spent)


@pytest.mark.parametrize("line", SLOW.values(), ids=SLOW)
def test_no_line_of_a_scene_takes_the_square_of_its_length(line: Callable[[int], str], tmp_path: Path, two_pads: str) -> None:
    """Each of these lines once took minutes, the second half of them in Python's own reader."""
    once, twice = (seconds_to_refuse(f"{two_pads}\n{line(count)}\n", tmp_path / "scene.toml") for count in (LONG_LINE, 2 * LONG_LINE))
    assert twice < GROWTH * once + NOISE


def test_numbers_and_words_between_dots_are_no_deep_key(tmp_path: Path, two_pads: str) -> None:
    path = tmp_path / "scene.toml"
    many = ", ".join(f"[{k}.5, 0.25, 1.0]" for k in range(50))
    words = f'"{"..." * 50} a.b.c. {"1.2." * 50}"'
    path.write_text(two_pads.replace('title   = "', f"# {'a.b.' * 50}\ntitle   = {words} #", 1) + f"# [{many}]")
    assert load_scene(path).title == words.strip('"')


@pytest.mark.parametrize("text", ["{} = 1\n", '[[block]]\nname = "{}"\n'])
def test_a_message_does_not_repeat_a_long_name(text: str, tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(text.format("k" * 100_000) + two_pads if text.startswith("{") else two_pads + text.format("k" * 100_000))
    assert main(["solve", str(path)]) == 2
    assert len(capsys.readouterr().err) < 5000


def test_a_result_s_file_is_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "file.h5"
    exchange.write(path, FIELDS, {"a/values": np.zeros((3, 3))}, "")
    monkeypatch.setattr(checksummed_file, "LARGEST_FILE", 100)
    with pytest.raises(exchange.ExchangeError, match="larger than 100 bytes, so crosscheck did not write it"):
        exchange.read(path, FIELDS)


# --- HDF5 files of other authors ----------------------------------------------------------------------------------------------

FIELDS = (exchange.Field("a/values", "f8", ("N", 3), "m", "some values"),)


def _external_link(file: h5py.File, other: Path) -> None:
    file["a/values"] = h5py.ExternalLink(str(other), "/a/values")


def _external_group(file: h5py.File, other: Path) -> None:
    del file["a"]
    file["a"] = h5py.ExternalLink(str(other), "/a")


def _soft_link(file: h5py.File, other: Path) -> None:
    file["b"] = h5py.ExternalLink(str(other), "/a/values")
    file["a/values"] = h5py.SoftLink("/b")


def _external_storage(file: h5py.File, other: Path) -> None:
    file.create_dataset("a/values", (3, 3), "f8", external=[(str(other), 0, 72)])


def _virtual(file: h5py.File, other: Path) -> None:
    layout = h5py.VirtualLayout((3, 3), "f8")
    layout[:] = h5py.VirtualSource(str(other), "/a/values", (3, 3))
    file.create_virtual_dataset("a/values", layout)


def _references(file: h5py.File, other: Path) -> None:
    file["b"] = h5py.ExternalLink(str(other), "/a/values")
    file.create_dataset("a/values", data=np.full((3, 3), file["a"].ref, dtype=object), dtype=h5py.ref_dtype)


def _huge_and_empty(file: h5py.File, other: Path) -> None:
    file.create_dataset("a/values", (10**12, 3), "f8", chunks=(1000, 3), fillvalue=1.0)


def _huge_and_never_written(file: h5py.File, other: Path) -> None:
    file.create_dataset("a/values", (10**11, 3), "f8", fillvalue=1.0)


def _packed(file: h5py.File, other: Path) -> None:
    file.create_dataset("a/values", data=np.zeros((10**6, 3)), compression="gzip")


HANDS = (
    _external_link, _external_group, _soft_link, _external_storage, _virtual, _references, _huge_and_empty, _huge_and_never_written,
    _packed,
)  # fmt: skip


@pytest.mark.parametrize("hand", HANDS)
def test_a_sealed_file_of_another_hand_reads_no_other_file_and_fills_no_memory(
    hand: Callable[[h5py.File, Path], None], tmp_path: Path
) -> None:
    """The links lead to a whole file with the requested data, so that a reader that follows them would succeed."""
    other, path = tmp_path / "other.h5", tmp_path / "file.h5"
    for each in (other, path):
        exchange.write(each, FIELDS, {"a/values": np.ones((3, 3))}, "")
    with h5py.File(path, "r+") as file:
        del file["a/values"]
        hand(file, other)
    checksummed_file.write_sealed(path, path.read_bytes())
    with pytest.raises(exchange.ExchangeError, match=r"missing|not stored as plain data|holds object"):
        exchange.read(path, FIELDS)


def test_a_report_of_stored_results_touches_nothing_outside_of_them(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    """Results may come from others: the meshes of their scene must not be links out of the folder."""
    out = tmp_path / "out"
    assert main(["run", "rubble_wall", "-o", str(out), "--no-yade", "-q"]) == 0
    folder = out / "rubble_wall"
    shutil.move(folder / "rubble_wall.obj", tmp_path / "rubble_wall.obj")
    (folder / "rubble_wall.obj").symlink_to(tmp_path / "rubble_wall.obj")
    capsys.readouterr()
    assert main(["report", str(out), "-q"]) == 2
    assert "a link that leads out" in capsys.readouterr().err
    assert find("rubble_wall").exists() and json.loads((folder / "comparison.json").read_text())["scene"] == "rubble_wall"
