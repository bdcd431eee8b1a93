"""The scene file as a schema (pydantic): every table and key, its type and its limits."""
