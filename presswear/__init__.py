"""Dynamics and wear of press linkages with clearance in their joints, in Exudyn."""
