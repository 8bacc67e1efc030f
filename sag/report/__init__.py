"""Reports: the rows of a sweep side by side with the paper's, as tables and a plot, and a file's score sheet."""

from sag.report.command_line import main
from sag.report.score_sheet import show_scores

__all__ = ["main", "show_scores"]
