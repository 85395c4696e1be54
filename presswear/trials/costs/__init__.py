"""Costs: wall times of features, of engines at equal work, and of the stages of a run."""
