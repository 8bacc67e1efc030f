"""`sag sample`: motions of any length from a photograph or a window of a data set, and what is made of them."""

from sag.sample.command_line import main

__all__ = ["main"]
