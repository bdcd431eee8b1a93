"""Campaigns: many scenes, or one over ranges of its keys, run side by side and gathered in one table."""
