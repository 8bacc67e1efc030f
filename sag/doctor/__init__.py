"""`sag doctor`: looks at a machine before hours are spent on it. Nothing here imports what may be broken."""
