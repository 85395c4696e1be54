"""Everything that a person chooses, and the named scenes."""
