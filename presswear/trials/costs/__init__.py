"""What the features of a model cost, how engines compare, and where the time goes."""
