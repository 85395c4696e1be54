"""What is kept of a run while it runs, and whether it is still sound."""
