"""Precision: speed against error of every engine and integrator."""
