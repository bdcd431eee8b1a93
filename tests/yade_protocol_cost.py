"""What a verdict costs in YADE, and a bare loop of as many steps: `/usr/bin/python3 yade_protocol_cost.py case.h5 [--rounds N]`, JSON.

Runs in YADE's own interpreter: the whole protocol, from bodies to plateau, then as many rounds as asked for of the protocol against the
same bodies and engines without the driver: gravity and the settlement at a constant speed, each in a single `O.run`. CPU seconds.
"""

import argparse
import json
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "yade_scripts"))
import run_case  # sets one thread before YADE loads
from process_memory import peak_memory

for package in ("la_core", "yade_scripts"):
    run_case.load_package(package)
sys.path.append(run_case.find_yade())
from la_core import exchange  # noqa: E402
from yade_scripts import bodies, case, protocol, recorder, settings  # noqa: E402


@dataclass
class Watched(protocol.Protocol):
    """The protocol; `rested`: steps until it rests under gravity; `watching`: seconds inside the driver's own code."""

    rested: int = 0
    watching: float = 0.0

    def _settle(self) -> None:
        self.rested = bodies.Omega().iter
        super()._settle()

    def watch(self) -> None:
        began = time.process_time()
        super().watch()
        self.watching += time.process_time() - began


def driven(one: case.Case, chosen: settings.Settings, stream) -> tuple[Watched, float]:
    """A run by the protocol, progress and all, and its seconds without those of building the model."""
    model = bodies.build(one, chosen, "watch()")
    run = Watched(one, chosen, model, recorder.Record(one, model), run_case.Reporter(stream).progress)
    sys.modules["__main__"].__dict__["watch"] = run.watch
    began = time.process_time()
    run.run()
    return run, time.process_time() - began


def bare(one: case.Case, chosen: settings.Settings, rested: int, steps: int, travel: float) -> float:
    """Seconds of a loop of as many steps without the driver: nothing watched, nothing recorded, at a constant speed to the same travel."""
    model = bodies.build(one, chosen, "pass")
    omega = bodies.Omega()
    omega.engines = [engine for engine in omega.engines if type(engine).__name__ != "PyRunner"]
    began = time.process_time()
    omega.run(rested, True)
    model.integrator.damping = 0.0
    bodies.set_speed(one, model.drive, travel / ((steps - rested) * chosen.time_step))
    omega.run(steps - rested, True)
    return time.process_time() - began


def measure(path: Path, rounds: int) -> dict:
    memory_before = peak_memory()
    one = case.from_fields(exchange.read(path, exchange.CASE_FIELDS))
    chosen = settings.derive(one)
    with Path(os.devnull).open("w") as nowhere:
        run, seconds = driven(one, chosen, nowhere)
        result = {
            "total": time.process_time(),  # of the whole process so far, loading YADE and building the model included
            "protocol": [seconds],
            "watching": [run.watching],
            "bare": [],
            "status": run.status.value,
            "steps": bodies.Omega().iter,
            "rested": run.rested,
            "rows": len(run.record.rows),
            "settling_rows": sum(row.stage == recorder.SETTLEMENT for row in run.record.rows),
            "poses": len(run.record.poses),
            "blocks": len(one.role),
            "contacts": len(one.host),
            "memory": peak_memory(),
            "memory_before": memory_before,
        }
        travel = run.record.settlement()
        for _ in range(rounds):
            result["bare"].append(bare(one, chosen, result["rested"], result["steps"], travel))
            run, seconds = driven(one, chosen, nowhere)
            result["protocol"].append(seconds)
            result["watching"].append(run.watching)
    return result


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure what a verdict costs in YADE, and a bare loop of as many steps.")
    parser.add_argument("case", type=Path)
    parser.add_argument("--rounds", type=int, default=0)
    options = parser.parse_args()
    print(json.dumps(measure(options.case, options.rounds)), flush=True)
    os._exit(0)
