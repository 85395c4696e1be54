"""Tests of precision, most of them on one short study or on made-up numbers."""
