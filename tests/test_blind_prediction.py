"""Limit analysis states its answer before it can see YADE's result: a cross-check proves nothing if one method uses the other.

One exception exists: `restored_effects.restore` adds an effect that was left out and that YADE's run shows to be needed. The first answer
is then kept and shown (`tests/comparison/test_first_prediction.py`).
"""

import ast
import dataclasses
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from blindness import DOOR, RESTORES, RUNS, House, functions, predictors

from la_core.analysis import LimitAnalysis
from la_core.analysis.result import Answers
from la_core.coulomb import CoulombSolution, EquilibriumPath
from la_core.limit import Solution

ROOT = Path(__file__).parent.parent
# Modules that call limit analysis directly. A further module belongs here only if YADE's result cannot reach its calls.
CALLERS = {
    "comparison.cli.scene_verbs.export", "comparison.cli.scene_verbs.solve", "comparison.studies.cost_limit_analysis",
    "comparison.studies.cost_yade", "comparison.studies.whole_studies", "comparison.limit_analysis", "comparison.workflow.restored_effects",
}  # fmt: skip
OF_YADE = ("run.h5", "result/", "record/", "poses/", "extra_contacts/")  # YADE's file, and the beginnings of the names of its fields
KINDS = (LimitAnalysis, Answers, CoulombSolution, EquilibriumPath, Solution)
CHANGEABLE = {"scene", "accuracy"}  # parts of an analysis: the scene's text, and the settings for YADE's next run


@cache
def sources(package: str) -> dict[str, str]:
    paths = (path for path in sorted((ROOT / package).rglob("*.py")) if path.parent.name != "tutorials")
    return {".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path.read_text("utf-8") for path in paths}


@cache
def predicting() -> set[str]:
    return predictors(sources("la_core"))


@cache
def house() -> House:
    return House(sources("comparison"), predicting())


def offences_with(text: str) -> list[str]:
    """Offences of a module of this text, added to the rooms that run YADE."""
    rooms = {name: source for name, source in sources("comparison").items() if name.startswith(("comparison.yade", "comparison.workflow"))}
    offences = House(rooms | {"comparison.workflow.added": text}, predicting()).offences()
    return [offence for offence in offences if offence.startswith("comparison.workflow.added:")]


# --- la_core ---------------------------------------------------------------------------------------------------------------------


def sights_of_yade(module: str, source: str) -> Iterator[str]:
    """Places where a module of la_core takes a run of YADE, reads a run from its file, or imports the packages that do."""
    for function in functions(module, source):
        if function.taken & RUNS or any(node.arg == "run" for node in ast.walk(function.node) if isinstance(node, ast.arg)):
            yield f"{function.key} takes a run"
    tree = ast.parse(source)
    texts = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings may name it
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in texts and node.value.startswith(OF_YADE):
            yield f"{module} names {node.value!r} in line {node.lineno}"
        elif isinstance(node, ast.Name | ast.alias) and (node.id if isinstance(node, ast.Name) else node.name) == "RUN_FIELDS":
            yield f"{module} names RUN_FIELDS"
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            yield from (f"{module} imports {name}" for name in names if name.split(".")[0] in ("comparison", "yade_scripts"))


@pytest.mark.parametrize("module", sources("la_core"))
def test_limit_analysis_takes_no_run_and_reads_none(module: str) -> None:
    """The exception is `la_core.exchange`, which defines the fields of a run and computes nothing."""
    if not module.startswith("la_core.exchange"):
        assert list(sights_of_yade(module, sources("la_core")[module])) == []


@pytest.mark.parametrize(
    "source",
    [
        "def predict(assembly, run): ...",
        "def predict(assembly, hint: 'Run | None' = None): ...",
        "def steps(folder):\n    return exchange.read(folder / 'run.h5', FIELDS)",
        "def steps(data):\n    return data['result/reaction']",
        "from la_core.exchange import RUN_FIELDS",
        "def steps(folder):\n    from comparison.yade import read_run",
    ],
)
def test_a_look_of_limit_analysis_at_a_run_is_noticed(source: str) -> None:
    assert list(sights_of_yade("la_core.coulomb.offender", source))


# --- comparison -------------------------------------------------------------------------------------------------------------------


def test_the_rule_knows_who_predicts_and_who_holds_a_run() -> None:
    """Without this knowledge the rule could not fail."""
    assert {"la_core:analyse", "la_core:predict", "la_core:solve", "la_core:solve_associated"} <= house().predicting
    assert {"comparison.limit_analysis:limit_analysis_stage", "comparison.workflow.one_scene:run_scene"} <= house().predicting
    assert not {DOOR, "comparison.workflow.one_scene:_compare", "comparison.judge.checks.run_checks:check_run"} & house().predicting
    assert DOOR in house().functions and house().first_sight("comparison.judge.checks.run_checks:check_run") == (0, 0)
    solved = house().first_sight("comparison.workflow.one_scene:_solved")
    assert solved is not None and solved > (0, 0)  # limit analysis comes first there
    assert house().first_sight("comparison.limit_analysis:limit_analysis_stage") is None
    assert {"SceneOutcome", "Result"} <= house().carriers


def test_nobody_predicts_with_a_run_in_hand_but_to_restore_an_effect() -> None:
    assert house().offences() == []


def test_the_modules_that_call_limit_analysis_are_listed() -> None:
    direct = {key.partition(":")[0] for key, uses in house().uses.items() for _, use in uses if use in predicting()}
    assert direct == CALLERS


def test_one_function_goes_through_the_door() -> None:
    through = {key for key, uses in house().uses.items() if DOOR in {use for _, use in uses}}
    assert through == {"comparison.workflow.one_scene:_better"}


def test_the_door_adds_effects_and_changes_nothing_in_the_way_of_predicting() -> None:
    tree = ast.parse(sources("comparison")[RESTORES])
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call) and ast.unparse(node.func) == "AnalysisSettings"]
    assert [[keyword.arg for keyword in call.keywords] for call in calls] == [["sliding_reason"]] and not calls[0].args


SECOND_LOOK = '''
"""Repeat a prediction that YADE contradicts in shorter steps, before the verdict: what this program once did."""
from comparison.judge.checks.reaction import check_prediction
from comparison.workflow import restored_effects
from comparison.yade import Results
from la_core.coulomb import PredictionSettings

def predictions(results: Results):
    for steps in (16, 32, 64):
        if not any(check.verdict == "disagree" for check in check_prediction(results)):
            return
        yield restored_effects._analyse_with(results.analysis, {}, PredictionSettings(steps))
'''
OFFENDERS = {
    "through the module that restores effects": SECOND_LOOK,
    "with a run as parameter": """
from comparison.yade import Run
from la_core.analysis import analyse

def again(scene, run: "Run | None"):
    return analyse(scene)
""",
    "with an object that holds a run": """
from comparison.workflow.one_scene import SceneOutcome
from la_core.analysis import AnalysisSettings, stage

def again(outcome: SceneOutcome):
    return stage.analyse(outcome.results.scene, AnalysisSettings())
""",
    "after it read a run": """
import la_core
from comparison.yade import read_results

def again(folder):
    results = read_results(folder)
    return la_core.solve(results.scene)
""",
    "by a helper": """
from comparison.workflow.stages import yade_stage
from la_core.coulomb import predict

def finer(assembly, steps):
    return predict(assembly, steps)

def again(analysis):
    run, yade = yade_stage(analysis)
    return finer(analysis.assembly, 16 if run.result.reaction > 1.0 else 8)
""",
    "in the next turn of a loop": """
from comparison.yade import read_run
from la_core.analysis import analyse

def again(scene, path):
    while True:
        analysis = analyse(scene)
        run = read_run(path, analysis.assembly)
""",
    "in a method of what holds a run": """
from comparison.yade import Run
from la_core.analysis import analyse

class Repeated:
    run: Run

    def again(self, scene):
        return analyse(scene)
""",
}


@pytest.mark.parametrize("source", OFFENDERS.values(), ids=OFFENDERS)
def test_a_prediction_with_a_run_in_hand_is_noticed(source: str) -> None:
    assert offences_with(source)


def test_a_prediction_before_the_run_is_allowed() -> None:
    innocent = """
from comparison.yade import read_run
from la_core.analysis import analyse

def once(scene, path):
    analysis = analyse(scene)
    return read_run(path, analysis.assembly)

def all_of(scenes, path):
    for scene in scenes:
        once(scene, path)
"""
    assert offences_with(innocent) == []


# --- made-up answers --------------------------------------------------------------------------------------------------------------


def forgeries(source: str) -> list[str]:
    """Calls of a module that make an answer of limit analysis by hand, or replace a part of an answer."""
    parts = {field.name for kind in KINDS for field in dataclasses.fields(kind)} - CHANGEABLE
    calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    names = [(call, ast.unparse(call.func).rpartition(".")[2]) for call in calls]
    made = [ast.unparse(call) for call, name in names if name in {kind.__name__ for kind in KINDS}]
    return made + [ast.unparse(call) for call, name in names if name == "replace" and parts & {one.arg for one in call.keywords}]


@pytest.mark.parametrize("module", sources("comparison"))
def test_an_answer_of_limit_analysis_is_never_made_or_changed_outside_of_it(module: str) -> None:
    assert forgeries(sources("comparison")[module]) == []


@pytest.mark.parametrize(
    "source",
    [
        "replace(analysis.coulomb, value=run.reaction)",
        "dataclasses.replace(analysis, at_inset=other)",
        "CoulombSolution(status, run.reaction)",
        "la_core.analysis.LimitAnalysis(scene, whole, at_inset)",
    ],
)
def test_an_answer_made_by_hand_is_noticed(source: str) -> None:
    assert forgeries(source)
