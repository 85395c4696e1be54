"""Speed against error: what each engine and integrator gives for its time."""
