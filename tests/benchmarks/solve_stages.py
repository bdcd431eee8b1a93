"""Processor seconds of one `crosscheck solve` by stage, as a line of JSON on standard error; benchmark_startup.py starts it.

    python tests/benchmarks/solve_stages.py solve SCENE [--bounds]

The interpreter takes the sources that it finds first, so that PYTHONPATH can name another version of the program.
"""

import gc
import json
import sys
import time
from collections import Counter
from collections.abc import Callable
from functools import wraps
from typing import Any

SOLVER = "solver"


def counted(owner: Any, attribute: str, stage: str, spent: Counter) -> None:
    """Make a function add its seconds to a stage, and subtract them from the stage that called it."""
    function: Callable = getattr(owner, attribute)

    @wraps(function)
    def wrapper(*args: object, **options: object) -> object:
        outer, spent["inside"] = spent["inside"], 0.0
        start = time.process_time()
        try:
            return function(*args, **options)
        finally:
            total = time.process_time() - start
            spent[stage] += total - spent["inside"]
            spent["inside"] = outer + total

    setattr(owner, attribute, wrapper)


def main() -> int:
    gc.disable()  # as the program's own entry does
    from comparison.cli import context, main
    from comparison.cli.scene_verbs import solve
    from comparison.progress import Narration
    from la_core.analysis import case_file, stage
    from la_core.coulomb import certificate, followed_path
    from la_core.coulomb.path import quasi_static_path
    from la_core.coulomb.path import rest as path_to_rest
    from la_core.geometry import touching
    from la_core.limit import associated, conic
    from la_core.model import assembly

    gc.freeze()
    gc.enable()
    spent: Counter = Counter(inside=0.0, loading=time.process_time())
    for owner, attribute, name in (
        (solve, "load_scene", "reading"),
        (touching, "_search", "contacts"),
        (assembly, "find_interfaces", "contacts"),
        (solve, "structural_model", "model"),
        (stage, "structural_model", "model"),
        (conic.Programme, "__init__", SOLVER),
        (conic.Programme, "solve", SOLVER),
        (path_to_rest, "advance", SOLVER),
        (quasi_static_path, "advance", SOLVER),
        (certificate, "certify", "evidence"),
        (associated, "_with_evidence", "evidence"),
        (followed_path, "PathProgress", "reports"),
        (followed_path.ElasticJoints, "value_in_units", "reports"),
        (Narration, "path", "reports"),
        (case_file, "scene_digest", "writing"),
        (case_file, "write_case", "writing"),
        (context.Context, "table", "tables"),
    ):
        counted(owner, attribute, name, spent)
    code = main(sys.argv[1:])
    total = time.process_time()
    del spent["inside"]
    print(json.dumps(dict(spent) | {"rest": total - sum(spent.values()), "total": total}), file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
