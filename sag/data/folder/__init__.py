"""A folder of one's own: any skeleton, one file of motion a recording, and pictures; `docs/own-data.md` shows it."""

from sag.data.folder.module import FolderDataModule

__all__ = ["FolderDataModule"]
