"""Verbs that take many runs: cost, sensitivity, campaign, compare."""
