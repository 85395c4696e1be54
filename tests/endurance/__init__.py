"""Kills, bad input, damaged files, full disks and memory."""
