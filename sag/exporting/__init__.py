"""`sag export`: motions of a file in other programs' formats and as films."""

from sag.exporting.command_line import main

__all__ = ["main"]
