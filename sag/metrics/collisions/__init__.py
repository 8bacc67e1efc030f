"""Bodies against points: counts, the non-collision ratio, own scenes against others, one motion in detail."""
