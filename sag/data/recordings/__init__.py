"""Data sets of recordings: what GTA-IM, PROX and a folder of one's own have in common once a recording is read."""

from sag.data.recordings.filters import Limits
from sag.data.recordings.module import RecordedDataModule
from sag.data.recordings.reader import Reader

__all__ = ["Limits", "Reader", "RecordedDataModule"]
