"""Verbs that help the user: doctor, completion, tutorial."""
