"""Endurance: what is tried so that nothing a person does can lose or falsify a result."""
