"""Data sets: each builds a window cache once and reads it at memory speed."""
