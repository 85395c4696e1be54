"""Does the second wear run away?  One reading changed at a time."""
