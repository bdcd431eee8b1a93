"""Verbs that work on scenes and their results: scenes, show, solve, run, report, export, animate."""
