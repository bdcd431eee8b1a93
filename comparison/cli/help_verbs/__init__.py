"""Verbs that help a user along: doctor, completion, tutorial."""
