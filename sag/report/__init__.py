"""Reports: the rows of a sweep side by side with the paper's, as tables and a plot."""

from sag.report.command_line import main

__all__ = ["main"]
