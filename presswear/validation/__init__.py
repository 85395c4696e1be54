"""Trials that hold the program against the truth."""
