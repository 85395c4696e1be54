"""Cross-check of the engines from one start."""
