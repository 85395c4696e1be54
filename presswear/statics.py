"""Linkages at rest: total clearance and deflection."""

from presswear.physics.statics import deflection, total_clearance

__all__ = ["deflection", "total_clearance"]
