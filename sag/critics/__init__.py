"""What the critics of a trained run listen to, and how hard each pulls."""

from sag.critics.command_line import main

__all__ = ["main"]
