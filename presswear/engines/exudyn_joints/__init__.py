"""Exudyn with bodies and joints, implicit: any linkage."""
