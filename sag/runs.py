"""Trained runs, read again from what they left in their folders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from jsonargparse import ArgumentParser

from sag.checkpoints import FOLDER, LAST, WholeCheckpoints
from sag.components import Components
from sag.data.base import MotionDataModule, Windows
from sag.errors import SagError
from sag.files import read_yaml
from sag.methods.base import Method
from sag.parsing import LINKS, one_sentence_each
from sag.types import Batch

CONFIG = "config.fit.yaml"
CHECKPOINT = Path(FOLDER) / LAST

USUAL_WINDOWS = 100
"""Test windows that are looked at where nobody says how many."""


@dataclass(frozen=True)
class Run:
    """A method as it was trained, with its data.

    Attributes:
        name: of the folder.
        method: with its weights, ready to sample.
        data: what it was trained on.
    """

    name: str
    method: Method
    data: MotionDataModule

    def windows(self, count: int | None) -> list[Batch]:
        """So many test windows, evenly over all of them, in batches; `USUAL_WINDOWS`, if there are, where none is told.

        Raises:
            SagError: there are fewer.
        """
        windows = Windows(self.data.cache, "test", self.data.skeleton)
        count = min(USUAL_WINDOWS, len(windows)) if count is None else count
        if not 1 <= count <= len(windows):
            raise SagError(f"--windows is {count}, and {self.data.name} has {len(windows)} test windows")
        places = torch.linspace(0, len(windows) - 1, count).round().long().tolist()
        size = self.data.eval_batch_size
        return [windows.__getitems__(places[first : first + size]) for first in range(0, count, size)]


def read_runs(folders: Sequence[Path], cache_dir: Path | None = None) -> list[Run]:
    """The trained methods of some folders.

    Args:
        folders: of runs, or of sweeps: then of all their finished rows.
        cache_dir: where the window caches are, if not where the runs had them.

    Raises:
        SagError: a folder holds no run, a file is missing or damaged, or the runs cannot be compared.
    """
    if cache_dir is not None and not cache_dir.is_dir():
        raise SagError(f"--cache-dir {cache_dir} is no folder; name the one that holds the window caches")
    places = [place for folder in folders for place in run_places(folder)]
    names = [place.resolve().name for place in places]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise SagError(f"two of the runs are called {twice[0]!r}, and a figure tells them apart by name: rename one")
    runs = [_read(place, name, cache_dir) for place, name in zip(places, names)]
    _check_comparable(runs)
    return runs


def read_run(place: Path, cache_dir: Path | None = None) -> Run:
    """The one trained method of a folder, or of a checkpoint in it.

    Args:
        place: folder of a run, or a .ckpt file in its `checkpoints` or beside its config.
        cache_dir: where the window caches are, if not where the run had them.

    Raises:
        SagError: there is none, there are several, or a file is missing or damaged.
    """
    if place.is_file():
        folder = run_folder(place)
        return _read(folder, folder.resolve().name, cache_dir, place)
    runs = read_runs([place], cache_dir)
    if len(runs) > 1:
        raise SagError(f"{place} is a sweep of {len(runs)} rows; name one of them, such as {place / runs[0].name}")
    return runs[0]


def run_folder(place: Path) -> Path:
    """The folder in which the config of a run lies.

    Args:
        place: the folder itself, or a checkpoint in its `checkpoints` or beside its config.

    Raises:
        SagError: a checkpoint has no config.
    """
    if not place.is_file():
        return place
    folder = place.parent.parent if place.parent.name == FOLDER else place.parent
    if not (folder / CONFIG).is_file():
        raise SagError(f"{place} has no {CONFIG} in {folder}; give the checkpoint in the folder of its run")
    return folder


def run_places(folder: Path) -> list[Path]:
    """The folder itself, or the finished rows in it: those with figures and a checkpoint."""
    if not folder.exists():
        raise SagError(f"{folder} does not exist; name the folder of a trained run or of a sweep")
    if (folder / CONFIG).is_file():
        return [folder]
    rows = sorted(path.parent for path in folder.glob("*/metrics.json"))
    found = [row for row in rows if (row / CONFIG).is_file() and (row / CHECKPOINT).is_file()]
    if not found:
        raise SagError(f"{folder} holds neither a run ({CONFIG}) nor finished rows of a sweep; train one by sag fit")
    return found


def _read(folder: Path, name: str, cache_dir: Path | None, checkpoint_path: Path | None = None) -> Run:
    path = checkpoint_path or folder / CHECKPOINT
    content = _config(folder / CONFIG)
    if cache_dir is not None:
        content["data"].setdefault("init_args", {})["cache_dir"] = str(cache_dir)
    parser = ArgumentParser(exit_on_error=False)
    parser.add_argument("--components", type=Components | None, default=None)
    parser.add_subclass_arguments(Method, "model", required=True)
    parser.add_subclass_arguments(MotionDataModule, "data", required=True)
    parser.link_arguments("components", "model.init_args.components")
    for argument in LINKS:
        parser.link_arguments(f"data.init_args.{argument}", f"model.init_args.{argument}")
    with one_sentence_each(about=f"{folder / CONFIG} is not of this version: "):
        made = parser.instantiate_classes(parser.parse_object(content))
    checkpoint = WholeCheckpoints().load_checkpoint(path)
    made.model.on_load_checkpoint(checkpoint)
    made.model.load_state_dict(checkpoint["state_dict"])
    if not made.model.trained:
        raise SagError(f"{path} is of a {type(made.model).__name__} that was not trained to the end")
    device = "cuda" if torch.cuda.is_available() else "cpu"
    return Run(name, made.model.to(device).eval(), made.data)


def _config(path: Path) -> dict[str, Any]:
    content = read_yaml(path)
    try:
        return {name: content[name] for name in ("components", "model", "data")}
    except (KeyError, TypeError) as error:
        raise SagError(f"{path} is not the config of a run ({error!r}); train it again") from error


def _check_comparable(runs: Sequence[Run]) -> None:
    """Refuses to lay runs on different windows, joints or pictures side by side."""
    first = runs[0]
    for run in runs[1:]:
        if run.data.cache.fingerprint != first.data.cache.fingerprint:
            raise SagError(
                f"{first.name} and {run.name} cannot stand in one figure: their data are {first.data.name} "
                f"{first.data.cache.fingerprint} and {run.data.name} {run.data.cache.fingerprint}; train them alike"
            )
