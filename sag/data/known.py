"""The data sets that are found on disk, by their layout."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sag.data.base import MotionDataModule
from sag.errors import SagError


@dataclass(frozen=True)
class KnownDataSet:
    """A data set that users have in a layout of its own.

    Attributes:
        name: of its config.
        title: what people call it.
        module: dotted path of its data module.
        inspector: dotted path of the function that checks it.
        signs: files and folders of which one at least lies in its root.
    """

    name: str
    title: str
    module: str
    inspector: str
    signs: tuple[str, ...]

    @property
    def module_class(self) -> type[MotionDataModule]:
        """Its data module."""
        return imported(self.module)


KNOWN = (
    KnownDataSet(
        "gta_im", "GTA-IM", "sag.data.gta_im.GtaImDataModule", "sag.data.check.gta_im.inspect", ("FPS-30", "FPS-5")
    ),
    KnownDataSet(
        "prox", "PROX", "sag.data.prox.ProxDataModule", "sag.data.check.prox.inspect", ("recordings", "PROXD")
    ),
    KnownDataSet(
        "folder",
        "a data set of your own",
        "sag.data.folder.FolderDataModule",
        "sag.data.check.folder.inspect",
        ("skeleton.yaml",),
    ),
)
"""Every data set that `sag data check` and `sag data prepare` know."""

DATA_SETS = {"rooms": "sag.data.rooms.RoomsDataModule"} | {known.name: known.module for known in KNOWN}
"""Data module of every data set, by the name of its config."""


def recognised(path: Path) -> tuple[KnownDataSet, Path]:
    """The data set that a folder belongs to, and its root, which may be a folder or two above.

    Raises:
        SagError: it is none that is known.
    """
    if not path.is_dir():
        raise SagError(f"{path} is {'no folder' if path.exists() else 'missing'}; give the root of a data set")
    whole = path.resolve()
    for root in (path, *whole.parents[:2]):
        for known in KNOWN:
            if any((root / sign).exists() for sign in known.signs):
                return known, root
    if any(path.glob("*/info_frames.*")):
        raise SagError(f"{path} holds recordings of GTA-IM: move them to {path / 'FPS-30'} or {path / 'FPS-5'}")
    expected = "; ".join(f"{' or '.join(known.signs)} for {known.title}" for known in KNOWN)
    raise SagError(f"{path} is in no layout that is known: it has none of {expected}")


def imported(name: str) -> Any:
    """What a dotted path names."""
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)
