"""Sweeps: a scene at many points, its responses, and sensitivity."""
