"""Generators: tables of a scene file that expand to blocks."""
