"""Verbs that need many runs: cost, sensitivity, campaign, compare."""
