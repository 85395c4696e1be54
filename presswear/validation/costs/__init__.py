"""Costs: engines beside peers at the same work, and wall times of features."""
