"""Forces between bodies: one file a kind, with its text in the equations and its kernels."""
