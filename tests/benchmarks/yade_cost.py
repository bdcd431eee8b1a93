"""Cost of a case in YADE: `/usr/bin/python3 yade_cost.py case.h5 STEPS [--profile] [--threads N]` prints one JSON object.

Runs in YADE's own interpreter. It takes STEPS settling steps right after the model is built, several times; the best time counts.
Seconds are processor time, without other work on the machine; with --threads they are wall time.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "yade_scripts"))
import run_case  # sets one thread before YADE loads

REPEATS = 3
CALLS = 5
clock = time.process_time


def measure(path: Path, steps: int, profile: bool) -> dict:
    """Return the seconds per step, recorded row and stored pose, and the numbers of bodies, interactions and bytes."""
    for package in ("la_core", "yade_scripts"):
        run_case.load_package(package)
    sys.path.append(run_case.find_yade())
    from la_core import exchange
    from yade_scripts import bodies, case, driving, recorder, settings

    began = time.process_time()
    one = case.from_fields(exchange.read(path, exchange.CASE_FIELDS))
    chosen = settings.derive(one)
    model = bodies.build(one, chosen, "pass")
    model.watch.dead = True
    built = time.process_time() - began
    omega = bodies.Omega()
    driving.set_speed(one, model.drive, chosen.speed)
    omega.run(steps, True)  # warm: contacts are found, springs loaded
    omega.timingEnabled = profile
    step = min(timed(lambda: omega.run(steps, True)) for _ in range(REPEATS)) / steps
    omega.timingEnabled = False
    record = recorder.Record(one, model)
    result = {
        "engines": [type(engine).__name__ for engine in omega.engines],
        "build": built,
        "step": step,
        "row": min(timed(lambda: record.read_row(exchange.SETTLEMENT)) for _ in range(CALLS)),
        "pose": min(timed(record.store_pose) for _ in range(CALLS)),
        "blocks": len(model.clump),
        "spheres": len(model.sphere),
        "interactions": len(list(omega.interactions.all())),
        "real": omega.interactions.countReal(),
        "pose_bytes": sum(array.nbytes for array in record.poses[-1][1:]),
        "poses": chosen.poses,
        "steps_of_travel": round(chosen.max_travel / chosen.speed / chosen.settling_step),
        "rows": chosen.record_rows,
    }
    if profile:
        result["profile"] = {type(engine).__name__: engine.execTime / 1e9 / (REPEATS * steps) for engine in omega.engines}
    return result


def timed(call) -> float:
    """Return the seconds of a call on the clock of this script."""
    began = clock()
    call()
    return clock() - began


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure what a case costs in YADE.")
    parser.add_argument("case", type=Path)
    parser.add_argument("steps", type=int)
    parser.add_argument("--profile", action="store_true")
    parser.add_argument("--threads", type=int)
    options = parser.parse_args()
    if options.threads is not None:
        os.environ["OMP_NUM_THREADS"], clock = str(options.threads), time.perf_counter
    print(json.dumps(measure(options.case, options.steps, options.profile)), flush=True)
    os._exit(0)
