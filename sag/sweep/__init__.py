"""Runs the rows of a sweep file."""
