"""Checkpoints that are whole, that know when they are damaged, and that execute nothing."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Any

import torch
from lightning.fabric.plugins.io.torch_io import TorchCheckpointIO

from sag.errors import Damaged, Diverged, OutOfSpace, SagError
from sag.files import FULL
from sag.seal import read_sealed, write_sealed

FOLDER = "checkpoints"
LAST, PREVIOUS = "last.ckpt", "previous.ckpt"
"""The newest checkpoint of a run, and the one before it."""


class WholeCheckpoints(TorchCheckpointIO):
    """Writes with a checksum under a temporary name, syncs and renames; reads tensors and plain types only."""

    def save_checkpoint(self, checkpoint: dict[str, Any], path: Any, storage_options: Any = None) -> None:
        """Writes a checkpoint so that the old file stays until the new one is whole.

        The file that a `last.ckpt` takes the place of stays as `previous.ckpt`, unless it is damaged.

        Raises:
            Diverged: a weight is no number; nothing is written.
            OutOfSpace: the disk is full; what was there stays as it is.
        """
        path = Path(path)
        _check_finite(checkpoint, path)
        keep = path.with_name(PREVIOUS) if path.name == LAST and _sound(path) else None
        archive = io.BytesIO()
        torch.save(checkpoint, archive)
        try:
            write_sealed(path, archive, keep)
        except OSError as error:
            if error.errno not in FULL:
                raise
            stays = f"the checkpoint of before is intact in {path}" if path.exists() else "there was none before"
            raise OutOfSpace(
                f"{path} cannot be written ({error.strerror}); {stays}: make room, then go on with --ckpt_path last"
            ) from error

    def load_checkpoint(self, path: Any, map_location: Any = None, weights_only: bool | None = None) -> dict[str, Any]:
        """Reads a checkpoint.

        Raises:
            Damaged: the file is not as it was written, or holds more than tensors and plain types.
            SagError: the file is missing.
        """
        if not Path(path).is_file():
            raise SagError(f"--ckpt_path {path} is no file")
        archive, sealed = read_sealed(Path(path))
        try:
            loaded = torch.load(archive, map_location=map_location or "cpu", weights_only=True)
        except Exception as error:
            reason = str(error).splitlines()[0]
            raise Damaged(f"--ckpt_path {path} is damaged or no checkpoint of this program: {reason}") from error
        if not isinstance(loaded, dict) or "state_dict" not in loaded:
            raise Damaged(f"--ckpt_path {path} is no checkpoint of this program: it holds no state_dict")
        if not sealed:
            notice(f"{path} is of an earlier version, without a checksum: damage in it would not be noticed")
        return loaded


def newest_good(folder: Path) -> Path | None:
    """The newest checkpoint of a run that can be read; says what is wrong with one that is passed over.

    Args:
        folder: of the run.
    """
    for path in (folder / FOLDER / LAST, folder / FOLDER / PREVIOUS):
        try:
            if path.is_file():
                WholeCheckpoints().load_checkpoint(path)
                return path
        except Damaged as error:
            notice(f"{error}; it is passed over")
    return None


def notice(sentence: str) -> None:
    """Tells the user what is not as usual and is taken care of."""
    print(f"notice: {sentence}", file=sys.stderr, flush=True)


def _sound(path: Path) -> bool:
    """Whether a file is there and as it was written: a damaged one must not take the place of a good one."""
    try:
        return bool(read_sealed(path))
    except (OSError, Damaged):
        return False


def _check_finite(checkpoint: dict[str, Any], path: Path) -> None:
    for name, value in checkpoint.get("state_dict", {}).items():
        if torch.is_tensor(value) and value.is_floating_point() and not value.isfinite().all():
            raise Diverged(
                f"{name} is no number any more at step {checkpoint.get('global_step')} of the optimisers, so {path} "
                "is left as it was: lower the learning rate, and go on or start anew"
            )
