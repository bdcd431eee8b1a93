"""Discrete-element side of the comparison: run one case inside YADE's own interpreter.

The package itself imports nothing, so that its numpy-only modules load in any interpreter.
"""
