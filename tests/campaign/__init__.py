"""Campaigns: replicates, wear updates and service lives."""
