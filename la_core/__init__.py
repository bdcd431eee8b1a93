"""Rigid-block limit analysis of dry-joint structures on a moving support.

This file imports nothing, so that YADE's own interpreter can load `la_core.exchange` alone.
"""
