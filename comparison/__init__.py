"""Runs both methods on a scene, judges one by the other, and reports."""
