"""Cost of a verdict in YADE, and of a bare loop of as many steps.

    /usr/bin/python3 yade_protocol_cost.py case.h5 [--rounds N | --verdict]

Prints JSON with CPU seconds. Runs in the interpreter of YADE. With --verdict it makes all attempts of a run. Otherwise it runs the
protocol at one speed, from bodies to plateau. Each of the N rounds then compares the protocol with the same bodies and engines without the
driver, gravity and settlement each in a single `O.run`: once with the speeds of the support that the driver set, and once at a constant
speed to the same travel. The constant speed costs YADE itself less.
"""

import argparse
import dataclasses
import json
import os
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "yade_scripts"))
import run_case  # sets one thread before YADE loads
from process_memory import peak_memory

for package in ("la_core", "yade_scripts"):
    run_case.load_package(package)
sys.path.append(run_case.find_yade())
from la_core import exchange  # noqa: E402
from yade_scripts import attempts, bodies, case, driving, protocol, recorder, settings  # noqa: E402
from yade_scripts.contacts import near_faces  # noqa: E402
from yade_scripts.expected_steps import expected_steps  # noqa: E402


@dataclass
class Watched(protocol.Protocol):
    """The protocol. rested: steps until rest under gravity; watching: seconds inside the driver; speeds: of the support, in turn."""

    rested: int = 0
    watching: float = 0.0
    speeds: list[float] = field(default_factory=list)

    def _set_speed(self, elapsed: float) -> None:
        super()._set_speed(elapsed)
        self.speeds.append(self._speed)

    def _settle(self) -> None:
        self.rested = bodies.Omega().iter
        super()._settle()

    def watch(self) -> None:
        began = time.process_time()
        super().watch()
        self.watching += time.process_time() - began


def driven(one: case.Case, chosen: settings.Settings, pace: float, near: near_faces.NearFaces | None, stream) -> tuple[Watched, float]:
    """Run the protocol with its progress reports. Return the run and its seconds, without those of building the model.

    pace: speed over that of the attempt that counts.
    """
    model = bodies.build(one, chosen, "watch()", calm="calm()")
    reporter = run_case.Reporter(stream)
    reporter.attempt(expected_steps(one, chosen, pace), chosen.time_limit)
    run = Watched(one, chosen, model, recorder.Record(one, model), reporter.progress, near, pace)
    sys.modules["__main__"].__dict__.update(watch=run.watch, calm=run.calm)
    began = time.process_time()
    run.run()
    return run, time.process_time() - began


def bare(run: Watched, steps: int, speeds: list[float]) -> float:
    """Return the seconds of a loop of `steps` steps without the driver. speeds: of the support, set in turn where the driver set them."""
    one, left = run.case, speeds[:0:-1]
    model, omega = bodies.build(one, run.settings, "watch()"), bodies.Omega()

    def watch() -> None:
        driving.set_speed(one, model.drive, left.pop())
        model.watch.dead = not left

    sys.modules["__main__"].__dict__["watch"] = watch
    model.watch.dead = True
    began = time.process_time()
    omega.run(run.rested, True)
    model.integrator.damping, omega.dt = 0.0, run.settings.settling_step
    driving.set_speed(one, model.drive, speeds[0])
    model.watch.dead, model.watch.iterPeriod = not left, run.model.watch.iterPeriod
    omega.run(steps - run.rested, True)
    return time.process_time() - began


def verdict(path: Path) -> dict:
    """Measure all attempts of a run."""
    memory_before = peak_memory()
    one = settings.affordable(case.from_fields(exchange.read(path, run_case.case_fields(path))))
    seconds, watching = [], []
    with Path(os.devnull).open("w") as nowhere:

        def attempt(changed: case.Case, chosen: settings.Settings, pace: float, near: near_faces.NearFaces | None) -> Watched:
            run, spent = driven(changed, chosen, pace, near, nowhere)
            seconds.append(spent)
            watching.append(run.watching)
            return run

        made = attempts.make(one, settings.derive(one), attempts.WithoutSearch(attempt))
    return {
        "total": time.process_time(),  # of the whole process so far, loading YADE and building the models included
        "protocol": [sum(seconds)],
        "watching": [sum(watching)],
        "status": made.last.status.value,
        "steps": made.steps,
        "blocks": len(one.role),
        "memory": peak_memory(),
        "memory_before": memory_before,
    }


def measure(path: Path, rounds: int) -> dict:
    """Measure the protocol at one speed, with and without the driver."""
    memory_before = peak_memory()
    one = settings.affordable(case.from_fields(exchange.read(path, run_case.case_fields(path))))
    chosen = settings.derive(one)
    near = near_faces.NearFaces(one, chosen) if one.displacement == "finite" else None
    one = dataclasses.replace(one, displacement="small")  # the attempts of a run begin so
    with Path(os.devnull).open("w") as nowhere:
        run, seconds = driven(one, chosen, 1.0, near, nowhere)
        result = {
            "total": time.process_time(),  # of the whole process so far, loading YADE and building the model included
            "protocol": [seconds],
            "watching": [run.watching],
            "bare": [],
            "constant": [],
            "status": run.status.value,
            "steps": bodies.Omega().iter,
            "rested": run.rested,
            "rows": len(run.record.rows),
            "settling_rows": sum(row.stage == exchange.SETTLEMENT for row in run.record.rows),
            "poses": len(run.record.poses),
            "blocks": len(one.role),
            "contacts": len(one.host),
            "memory": peak_memory(),
            "memory_before": memory_before,
        }
        first, steps = run, result["steps"]
        constant = first.record.settlement() / ((steps - first.rested) * chosen.settling_step)
        for _ in range(rounds):
            result["bare"].append(bare(first, steps, first.speeds))
            result["constant"].append(bare(first, steps, [constant]))
            run, seconds = driven(one, chosen, 1.0, near, nowhere)
            result["protocol"].append(seconds)
            result["watching"].append(run.watching)
    return result


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure what a verdict costs in YADE, and a bare loop of as many steps.")
    parser.add_argument("case", type=Path)
    parser.add_argument("--rounds", type=int, default=0)
    parser.add_argument("--verdict", action="store_true", help="all attempts, as a run of the program makes them")
    options = parser.parse_args()
    print(json.dumps(verdict(options.case) if options.verdict else measure(options.case, options.rounds)), flush=True)
    os._exit(0)
