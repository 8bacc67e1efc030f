"""Motion alone: velocities, smoothness, bones, samples against each other and against the truth."""
