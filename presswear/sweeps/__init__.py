"""Sweeps: one scene at many points, what was measured there, and what follows from it."""
