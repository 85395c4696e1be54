"""Results of a run: writing, resuming, reading and export."""
