"""Validation of the program against closed forms, references and other engines, and benchmarks."""
