"""Exudyn with an open tree in minimal coordinates, explicit and error-controlled."""
