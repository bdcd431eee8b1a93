"""A run of YADE that ends itself by SIGKILL at a moment: `dying_yade.py MOMENT run_case.py ...`, run by YADE's interpreter.

The moment is "loaded", the number of a row over all attempts, or "written", when the results are in a file with the name of an unfinished
file. At "never" the run ends normally, and writes its number of rows into the file `rows` beside its results.
"""

import importlib.util
import os
import signal
import sys
from pathlib import Path
from typing import Any

LOADED, WRITTEN, NEVER = "loaded", "written", "never"


def die(*_: Any) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def main() -> int:
    moment, script = sys.argv[1:3]
    spec = importlib.util.spec_from_file_location("run_case", script)
    assert spec is not None and spec.loader is not None
    run_case = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(run_case)
    rows, report = 0, run_case.Reporter.progress

    def count(*row: Any) -> None:
        nonlocal rows
        rows += 1
        report(*row)
        if str(rows) == moment:
            die()

    run_case.Reporter.progress = count
    if moment == LOADED:
        run_case.Reporter.loaded = die
    if moment == WRITTEN:
        Path.replace = die  # type: ignore[assignment]
    del sys.argv[:2]
    code = int(run_case.main())
    if moment == NEVER:
        Path(sys.argv[2]).with_name("rows").write_text(str(rows))
    return code


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
