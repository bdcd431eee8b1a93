"""A case held at rest for many steps: `/usr/bin/python3 yade_hold.py case.h5 STEPS` prints JSON. Runs in YADE's own interpreter.

The protocol brings the case to rest under gravity. Then its damping is removed, and the support does not move for STEPS steps.
"""

import json
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "yade_scripts"))
import run_case  # sets one thread before YADE loads

for package in ("la_core", "yade_scripts"):
    run_case.load_package(package)
sys.path.append(run_case.find_yade())
from la_core import exchange  # noqa: E402
from yade_scripts import bodies, case, protocol, recorder, settings  # noqa: E402

ROWS = 50


class Held(protocol.Protocol):
    """The protocol with a support that does not move."""

    hold: int = 0

    def _settle(self) -> None:
        self.model.integrator.damping, bodies.Omega().dt = 0.0, self.settings.settling_step
        self.rested = len(self.record.rows)
        self.model.watch.iterPeriod = max(1, self.hold // ROWS)
        self.sag = self.record.poses[-1].displacement
        bodies.Omega().run(self.hold, True)
        self.record.store_pose()

    def _watch_gravity(self, row: recorder.Row) -> None:
        if not hasattr(self, "rested"):
            super()._watch_gravity(row)

    def _judge(self) -> None:
        self._end(protocol.Status.NO_PLATEAU, "held")


def main() -> None:
    one = case.from_fields(exchange.read(Path(sys.argv[1]), exchange.CASE_FIELDS))
    chosen = settings.derive(one)
    model = bodies.build(one, chosen, "watch()", calm="calm()")
    run = Held(one, chosen, model, recorder.Record(one, model), lambda *report: None)
    run.hold = int(sys.argv[2])
    sys.modules["__main__"].__dict__.update(watch=run.watch, calm=run.calm)
    run.run()
    held = run.record.rows[run.rested :]
    moved = abs(run.record.poses[-1].displacement - run.sag).max()
    print(json.dumps({
        "at rest": run.record.rows[run.rested - 1].kinetic_energy,
        "held": [row.kinetic_energy for row in held],
        "reaction": [run.record.rows[run.rested - 1].reaction, held[-1].reaction],
        "moved": moved, "sag": abs(run.sag).max(), "rest_energy": chosen.rest_energy,
    }), flush=True)  # fmt: skip
    os._exit(0)


main()
