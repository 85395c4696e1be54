"""The outer loop: starts, statistics, wear applied, checkpoints."""
