"""The report of a campaign, and the comparison of two campaigns."""
