"""`sag figure`: strips of poses in one picture, as in the paper's Figures 1, 4 and 8, and contact sheets of runs."""

from sag.figures.command_line import main

__all__ = ["main"]
