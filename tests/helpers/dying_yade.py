"""A YADE that dies by SIGKILL at a moment of its run: `dying_yade.py MOMENT run_case.py ...`, run by YADE's interpreter.

The moment is "loaded", the number of a row, or "written", when the results lie under the name of an unfinished file.
"""

import importlib.util
import os
import signal
import sys
from pathlib import Path
from typing import Any

LOADED, WRITTEN = "loaded", "written"


def die(*_: Any) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def main() -> int:
    moment, script = sys.argv[1:3]
    spec = importlib.util.spec_from_file_location("run_case", script)
    assert spec is not None and spec.loader is not None
    run_case = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(run_case)
    rows = 0

    def count(*_: Any) -> None:
        nonlocal rows
        rows += 1
        if str(rows) == moment:
            die()

    run_case.Reporter.progress = count
    if moment == LOADED:
        run_case.Reporter.forecast = die
    if moment == WRITTEN:
        Path.replace = die  # type: ignore[assignment]
    del sys.argv[:2]
    return int(run_case.main())


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
