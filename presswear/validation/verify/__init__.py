"""Verification of the engines against references that nobody here wrote."""
