"""Nonlinear dynamics of a motion: spectra, periods, contact modes, exponents, bifurcation."""
