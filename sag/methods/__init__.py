"""Systems that train, or that only sample, under one protocol."""
