"""Do the intervals hold?  Many independent campaigns of one scene beside a long one."""
