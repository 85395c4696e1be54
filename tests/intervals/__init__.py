"""Trials of coverage: how many stated intervals contain the true value."""
