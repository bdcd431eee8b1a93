"""One attempt of a case in YADE: `/usr/bin/python3 protocol_attempt.py case.h5 PACE STIFFER SETTINGS` prints one JSON object.

Runs in YADE's own interpreter. PACE and STIFFER: speed and stiffness of the joints over the derived values. SETTINGS: overrides as a
JSON object, besides those of the scene.
"""

import dataclasses
import json
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "yade_scripts"))
import run_case  # sets one thread before YADE loads

for package in ("la_core", "yade_scripts"):
    run_case.load_package(package)
sys.path.append(run_case.find_yade())
from la_core import exchange  # noqa: E402
from yade_scripts import attempts, bodies, case, protocol, recorder, settings  # noqa: E402


def main() -> None:
    one = settings.affordable(case.from_fields(exchange.read(Path(sys.argv[1]), run_case.case_fields(Path(sys.argv[1])))))
    stiffening = float(sys.argv[3]) * settings.derive(one).stiffening
    one = dataclasses.replace(one, overrides=one.overrides | {"stiffening": stiffening} | json.loads(sys.argv[4]))
    chosen = attempts.settings_of(one, settings.derive(one), attempts.Plan(float(sys.argv[2])))
    model = bodies.build(one, chosen, "watch()", calm="calm()")
    run = protocol.Protocol(one, chosen, model, recorder.Record(one, model), lambda *report: None)
    sys.modules["__main__"].__dict__.update(watch=run.watch, calm=run.calm)
    began = time.process_time()
    run.run()
    print(json.dumps({
        "status": run.status.value, "creeps": bool(run.plateau.creeps), "reaction": run.outcome.reaction,
        "uncertainty": run.outcome.uncertainty, "steps": run.steps, "seconds": time.process_time() - began,
        "travelled": run.record.settlement() / chosen.max_travel,
    }), flush=True)  # fmt: skip
    os._exit(0)


main()
