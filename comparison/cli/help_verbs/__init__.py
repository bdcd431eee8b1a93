"""Verbs that help the user: new, schema, doctor, completion, tutorial."""
