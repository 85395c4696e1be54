"""The in-house solver: Lagrange multipliers, compiled."""
