from comparison.result import Picture as Picture
from comparison.result import Result as Result
from comparison.result import draw as draw
from comparison.result import read as read
from comparison.result import run as run
from comparison.verdict.check import Check as Check
from comparison.verdict.check import Verdict as Verdict
from comparison.yade.run_record import Run as Run

__all__ = ["Check", "Picture", "Result", "Run", "Verdict", "draw", "read", "run"]
