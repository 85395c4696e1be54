"""Engine against engine, from one start."""
