"""The quasi-static path: elastic joints with friction, one implicit step, rest under gravity, and the way from rest."""
