"""The paper's Figure 7: how far trajectories with the same start and the same end part on the way."""

from sag.figure7.command_line import main

__all__ = ["main"]
