"""Looks at a data set as it lies on disk, so that nobody trains to learn that a download is broken."""

from __future__ import annotations

from sag.data.check.report import Line, Report, Section

__all__ = ["Line", "Report", "Section"]
