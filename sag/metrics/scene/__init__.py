"""Bodies against floor, furniture and depth: what fits the scene, and where feet are."""
