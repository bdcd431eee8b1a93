"""The checks: each compares one quantity of both methods with its tolerance and says agree, disagree or inconclusive, with a reason."""
