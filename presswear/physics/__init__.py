"""Compiled functions from a state to constraints, tree motion, contact, forces, wear and energy."""
