"""Sweeps: a scene at many points or a list of scenes, their responses, and sensitivity."""
