"""The command line: parses the arguments, calls the other rooms and prints; one module for each verb."""

from comparison.cli.commands import COMMANDS, main

__all__ = ["COMMANDS", "main"]
