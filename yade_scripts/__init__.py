"""Discrete-element side of the comparison: run one case inside YADE's own interpreter.

This package imports nothing by itself, so that its numpy-only modules load in any interpreter.
"""
