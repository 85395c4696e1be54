"""Campaign of a scene: replicates, statistics, wear updates and checkpoints."""
