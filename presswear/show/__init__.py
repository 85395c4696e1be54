"""Figures, report and replay of a result."""
