"""The engines against references that nobody here wrote."""
