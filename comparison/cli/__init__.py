"""The command line: reads words, calls the rooms, prints; one module for each verb."""

from comparison.cli.commands import COMMANDS, main

__all__ = ["COMMANDS", "main"]
