"""Do the intervals hold?  Independent campaigns of one scene beside the mean of long ones."""
