"""How long a scene lives beside others like it: materials, clearances, bushes made new."""
