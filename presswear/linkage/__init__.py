"""A mechanism as data: bodies, joints, drives, loads, laws, surfaces, and the named mechanisms."""
