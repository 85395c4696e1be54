"""Equations of motion written for a linkage, as one function of straight-line Python text."""
