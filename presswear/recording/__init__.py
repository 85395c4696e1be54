"""Records of a run while it runs, and the checks that it is still sound."""
