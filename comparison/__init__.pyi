from comparison.check import Check as Check
from comparison.check import Verdict as Verdict
from comparison.record import Run as Run
from comparison.result import Picture as Picture
from comparison.result import Result as Result
from comparison.result import draw as draw
from comparison.result import read as read
from comparison.result import run as run

__all__ = ["Check", "Picture", "Result", "Run", "Verdict", "draw", "read", "run"]
