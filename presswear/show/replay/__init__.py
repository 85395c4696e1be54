"""Replay of stored runs in Exudyn's renderer: windows, films and stills."""
