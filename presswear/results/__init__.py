"""A result: written whole, gone on with, read back and exported."""
