"""A whole command, `crosscheck solve FILE --bounds`, and the same command with HiGHS in place of our solver.

Both read the file, find the joints, compute both bounds with and without inset, check them and print them. Every command runs in
its own process with one thread. HiGHS builds its matrices anew for each bound; our solver shares them.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import json
import math
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median

import tomli_w
from benchmark_large import BLOCK, wall_tables
from marked_text import listed
from peers_limit import HIGHS
from peers_process import ONE_THREAD, PeerEnded, PeerTooSlow
from peers_table import OURS, at_least, markdown, number

from la_core.limit.linearised import LEAST_FACETS

WALLS = {500: (22, 22), 1000: (31, 32), 2000: (44, 45), 5000: (70, 71)}  # blocks in a course and courses, by the number of blocks
METHODS = (OURS, *HIGHS)
REPEATS = 3
PROGRAMME = f"""
import sys
path, algorithm = sys.argv[1:]
solved = []
if algorithm:
    from la_core.analysis import one_pass
    from la_core.limit import solve_linearised
    def by_highs(assembly, drive, *_, **__):
        solved.append(drive)
        return solve_linearised(assembly, drive, {LEAST_FACETS}, True, algorithm)
    one_pass.solve_associated = by_highs
from comparison.cli import main
code = main(["solve", path, "--bounds", "--json", "-q"])
sys.exit(code if bool(solved) == bool(algorithm) else "the bounds were not computed by HiGHS")
"""


@dataclass(frozen=True)
class Command:
    """The command with one method on one wall.

    processor: processor seconds of the whole process, one for each repeat. value: least reaction over the weight. limit: processor seconds
    after which the command was ended. note: reason for a missing answer.
    """

    blocks: int
    method: str
    value: float = math.nan
    processor: tuple[float, ...] = ()
    limit: float = math.nan
    note: str = ""

    @property
    def seconds(self) -> float:
        """Median over the repeats."""
        return median(self.processor) if self.processor else math.nan


def measure(blocks: int, method: str, limit: int) -> tuple[float, float]:
    """Return the least reaction over the weight, and the processor seconds of the whole process.

    Raises PeerEnded where a command ends without an answer, and PeerTooSlow where it has not ended after `limit` processor seconds.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "wall.toml"
        path.write_text(tomli_w.dumps(wall_tables(BLOCK, *WALLS[blocks])), encoding="utf-8")
        command, before = [sys.executable, "-c", PROGRAMME, str(path), HIGHS.get(method, "")], os.times()
        end_at_limit = partial(resource.setrlimit, resource.RLIMIT_CPU, (limit, limit + 1))  # the first limit sends SIGXCPU, not SIGKILL
        done = subprocess.run(
            command, env={**os.environ, **ONE_THREAD}, capture_output=True, text=True, preexec_fn=end_at_limit, check=False
        )  # fmt: skip
    after = os.times()
    if done.returncode == -signal.SIGXCPU:
        raise PeerTooSlow(f"time limit of {limit} s")
    if done.returncode != 0:
        raise PeerEnded(" ".join(done.stderr.split())[-200:] or f"exit code {done.returncode}")
    answer = json.loads(done.stdout)
    used = after.children_user + after.children_system - before.children_user - before.children_system
    return answer["limit_analysis"]["associated"]["reaction"] / answer["weight"], used


def ratios(commands: Sequence[Command]) -> dict[int, float]:
    """Return the seconds of HiGHS's fastest algorithm over ours, by number of blocks."""
    own = {one.blocks: one.seconds for one in commands if one.method == OURS and math.isfinite(one.seconds)}
    found = {}
    for blocks, seconds in own.items():
        others = [one.seconds for one in commands if one.blocks == blocks and one.method != OURS and math.isfinite(one.seconds)]
        if others:
            found[blocks] = min(others) / seconds
    return found


def command_table(commands: Sequence[Command]) -> str:
    """Return the table of the commands as Markdown, in their order."""
    own = {one.blocks: one.seconds for one in commands if one.method == OURS}
    lines = [
        (
            f"{one.blocks:,}", one.method, f"{one.value:.6f}" if math.isfinite(one.value) else "–", at_least(one.seconds, one.limit),
            at_least(one.seconds / own[one.blocks], one.limit / own[one.blocks]), one.note,
        )
        for one in commands
    ]  # fmt: skip
    return markdown(("blocks", "bounds by", "least R/W", "CPU s", "ratio", "note"), lines)


def conclusion(commands: Sequence[Command]) -> str:
    """Return the conclusion as a sentence; empty without a ratio."""
    found = [f"{number(ratio)} times as long on {blocks:,} blocks" for blocks, ratio in ratios(commands).items()]
    return f"With HiGHS in place of our solver, the whole command for the bounds takes {listed(found)}." if found else ""
