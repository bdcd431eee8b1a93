"""Verbs that take one scene, or the results of one: scenes, show, solve, run, report, export, animate."""
