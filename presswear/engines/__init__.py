"""Engines: a linkage, a start and a plan in, a run out."""
