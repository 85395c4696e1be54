"""Scenes: mechanism, bearings, loads and options of a simulation, and the named scenes."""
