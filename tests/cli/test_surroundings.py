"""Closed or full streams and missing parts end with the documented exit code, never with a traceback or the code of a verdict."""

import errno
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from faulty_runs import ROOT, TOOL, one_message

import comparison
from comparison.__main__ import main as entry
from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE
from comparison.errors import message_of
from comparison.run_folder import folder_of_results
from la_core.errors import SceneError, missing_part
from la_core.scene.shipped import find

USAGE = 2


def by_shell(words: str, streams: str) -> "subprocess.CompletedProcess[str]":
    line = f'exec "{sys.executable}" -m comparison {words} {streams}'
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(["sh", "-c", line], env=environment, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("streams", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams_take_what_is_printed(streams: str, tmp_path: Path) -> None:
    ended = by_shell(f'run two_pads --no-yade -o "{tmp_path / "out"}"', streams)
    assert ended.returncode == 0 and "error" not in ended.stderr, ended.stderr
    assert (tmp_path / "out" / "report.html").exists()


@pytest.mark.parametrize(("words", "code"), [("solve nothing_of_that_name", USAGE), ("no_command", USAGE)])
def test_an_error_that_nobody_can_be_told_is_no_disagreement(words: str, code: int) -> None:
    assert by_shell(words, "2>/dev/full").returncode == code


def test_work_goes_on_where_nobody_can_be_told_of_it(tmp_path: Path) -> None:
    """A log on a full disk must not end a campaign of hours."""
    ended = by_shell(f'run two_pads --no-yade -o "{tmp_path / "out"}"', "2>/dev/full")
    assert ended.returncode == AGREE and "expected value met" in ended.stdout


@pytest.mark.slow
def test_work_goes_on_where_the_terminal_is_gone(tmp_path: Path) -> None:
    """Progress bars write to the terminal, too."""
    ours, theirs = os.openpty()
    command = [sys.executable, "-m", "comparison", "run", "two_pads", "--no-yade", "-o", str(tmp_path / "out")]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=theirs, env=environment, cwd=ROOT, text=True) as running:
        os.close(theirs)
        os.close(ours)
        said, _ = running.communicate()
    assert running.returncode == AGREE and "expected value met" in said


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("name", "value", "words"), [("MPLBACKEND", "Qt4Agg", "show two_pads -q -o pads.png"), ("OMP_NUM_THREADS", "²", "solve two_pads -q")]
)
def test_a_variable_meant_for_a_library_ends_no_command(
    name: str, value: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A backend that matplotlib has dropped may stay in a user's profile for years."""
    monkeypatch.setenv(name, value)
    command, environment = [sys.executable, "-m", "comparison", *words.split()], {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == AGREE and not ended.stderr, ended.stderr


def test_a_style_of_matplotlib_that_is_not_utf8_is_named(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_bytes(b"axes.labelsize: 12  # \xe9t\xe9\n")
    command, environment = [sys.executable, "-m", "comparison", "show", "two_pads", "-q"], {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == TOOL and "unexpected" not in ended.stderr
    assert f"error: {tmp_path / 'matplotlibrc'}: matplotlib cannot read" in ended.stderr and "save it in UTF-8" in ended.stderr


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("words", "code"),
    [
        ("solve büro.toml", USAGE),
        ("campaign büro.toml --no-yade", USAGE),
        ("campaign of_it.toml --no-yade", TOOL),
        ("new --from büro.obj", USAGE),
        ("run two_pads --no-yade --title Büro", USAGE),
        ("show of_mesh.toml", USAGE),
    ],
)
def test_a_name_that_the_locale_has_no_letters_for_asks_for_another_locale(words: str, code: int, tmp_path: Path) -> None:
    sweep = 'yade = false\n[[sweep]]\nscene = "büro.toml"\nvary = { "joint.friction" = [0.3] }\n'
    shutil.copy(find("two_pads"), tmp_path / "büro.toml")
    shutil.copy(find("rubble_wall").with_suffix(".obj"), tmp_path / "büro.obj")
    (tmp_path / "of_it.toml").write_text(sweep, encoding="utf-8")
    mesh = find("rubble_wall").read_text(encoding="utf-8").replace("rubble_wall.obj", "büro.obj")
    (tmp_path / "of_mesh.toml").write_text(mesh, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "LC_ALL": "C", "PYTHONUTF8": "0"}
    command = [sys.executable, "-m", "comparison", *words.split(), "-q"]
    ended = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == code
    one_message(ended.stderr, "LC_ALL=C.UTF-8")


def test_a_campaign_or_drawing_whose_name_is_no_text_is_to_be_renamed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for words, ending in ((["campaign"], "toml"), (["new", "--from"], "obj")):
        path = tmp_path / os.fsdecode(b"b\xe9." + ending.encode())
        path.write_text('[[sweep]]\nscene = "two_pads"\nvary = { "joint.friction" = [0.3] }\n', encoding="utf-8")
        assert main([*words, str(path), "-q"]) == USAGE
        one_message(capsys.readouterr().err, "must be printable text", "rename the file")


@pytest.mark.parametrize("part", ["rich", "h5py", "clarabel", "jinja2"])
def test_a_missing_part_is_named_with_what_completes_the_installation(part: str, tmp_path: Path) -> None:
    command = ["run", "two_pads", "--no-yade", "-q", "-o", str(tmp_path)]
    code = f"import sys; sys.modules[{part!r}] = None; sys.argv[1:] = {command!r}; from comparison.__main__ import main; sys.exit(main())"
    ended = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == TOOL
    one_message(ended.stderr, f"the Python module {part}", "is missing", f"{shlex.quote(sys.executable)} -m pip install")


def test_windows_is_told_where_the_program_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Python on Windows lacks modules of the standard library, so a message once called the installation incomplete."""
    monkeypatch.setattr(sys, "platform", "win32")
    assert entry() == TOOL
    one_message(capsys.readouterr().err, "install it in WSL", "wsl --install")
    with pytest.raises(ImportError, match="install it in WSL"):
        _ = comparison.run


def test_a_missing_part_of_an_installation_by_pipx_is_completed_by_pipx(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "pipx_metadata.json").write_text("{}")
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert "`pipx reinstall crosscheck-masonry` completes it" in missing_part(ModuleNotFoundError("no rich", name="rich"))


def test_a_current_folder_that_is_gone_is_named(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    line = f'cd "{gone}" && rmdir "{gone}" && exec "{sys.executable}" -m comparison run two_pads --no-yade -q -o "{tmp_path / "out"}"'
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(["sh", "-c", line], env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == TOOL
    one_message(ended.stderr, "the current folder: No such file or directory")


NEXT_STEPS = {
    "full": (errno.ENOSPC, "free some space"),
    "read-only": (errno.EROFS, "can be written"),
    "closed": (errno.EACCES, "can be written"),
    "not permitted": (errno.EPERM, "can be written"),
    "file too large": (errno.EFBIG, "ulimit -f"),
    "too many open files": (errno.EMFILE, "ulimit -n"),
    "name too long": (errno.ENAMETOOLONG, "a shorter name"),
    "links in a loop": (errno.ELOOP, "a link leads to itself"),
}


@pytest.mark.parametrize(("number", "step"), NEXT_STEPS.values(), ids=NEXT_STEPS)
def test_a_disk_that_refuses_brings_a_next_step(number: int, step: str) -> None:
    assert message_of(OSError(number, os.strerror(number), "case.h5")).startswith(f"case.h5: {os.strerror(number)}; ")
    assert step in message_of(OSError(number, os.strerror(number), "case.h5"))


@pytest.mark.parametrize("closed", ["case.h5", "."])
def test_what_another_user_closed_to_readers_is_to_be_opened_by_its_owner(
    closed: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tests may run as root, who may read everything, so the answers of the system are imitated."""
    shut = (tmp_path / closed).resolve()
    error = PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(tmp_path / "case.h5"))

    def access(path: Path, mode: int) -> bool:
        return mode == os.F_OK or path != shut

    monkeypatch.setattr(os, "access", access)
    assert "ask its owner to permit it" in message_of(error)
    monkeypatch.setattr(os, "access", lambda *_: True)
    assert "choose a folder that can be written" in message_of(error)


def test_a_library_that_memory_is_too_short_for_is_no_error_of_the_program() -> None:
    message = message_of(ImportError("_imaging.so: failed to map segment from shared object"))
    assert message.startswith("out of memory (_imaging.so: ") and "more memory" in message


def test_a_folder_in_the_place_of_a_result_brings_a_next_step(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "two_pads" / "case.h5").mkdir(parents=True)
    assert main(["run", "two_pads", "--no-yade", "-q", "-o", str(tmp_path)]) == TOOL
    one_message(capsys.readouterr().err, "case.h5: Is a directory; a folder stands where a file is needed")


def test_a_folder_that_is_a_link_to_itself_is_no_error_of_the_program(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "friction.toml").write_text('[[sweep]]\nscene = "two_pads"\nvary = { "joint.friction" = [0.3, 0.6] }\n')
    assert main(["campaign", str(tmp_path / "friction.toml"), "--no-yade", "-q", "-o", str(tmp_path / "loop")]) == TOOL
    one_message(capsys.readouterr().err, "loop: File exists: a link that leads nowhere stands where a folder is needed")
    with pytest.raises(SceneError, match=r"a link that leads nowhere, .*loop, stands where a folder is needed"):
        folder_of_results(tmp_path / "loop")


def test_a_run_leaves_no_pipe_of_yade_open(tmp_path: Path) -> None:
    program = tmp_path / "python"
    program.write_text("#!/bin/sh\nexit 7\n")
    program.chmod(0o755)
    command = [sys.executable, "-W", "always::ResourceWarning", "-m", "comparison", "run", "two_pads", "-q", "-o", str(tmp_path / "out")]
    environment = {**os.environ, "CROSSCHECK_YADE_PYTHON": str(program)}
    ended = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == TOOL and "ResourceWarning" not in ended.stderr, ended.stderr
