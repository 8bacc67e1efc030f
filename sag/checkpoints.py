"""Checkpoints that are whole and that execute nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import torch
from lightning.fabric.plugins.io.torch_io import TorchCheckpointIO

from sag.errors import SagError
from sag.files import write_whole


class WholeCheckpoints(TorchCheckpointIO):
    """Writes under a temporary name, syncs and renames; reads tensors and plain types only."""

    def save_checkpoint(self, checkpoint: dict[str, Any], path: Any, storage_options: Any = None) -> None:
        """Writes a checkpoint so that the old file stays until the new one is whole."""
        write_whole(Path(path), lambda file: torch.save(checkpoint, file))

    def load_checkpoint(self, path: Any, map_location: Any = None, weights_only: bool | None = None) -> dict[str, Any]:
        """Reads a checkpoint.

        Raises:
            SagError: the file is missing, damaged, or holds more than tensors and plain types.
        """
        if not Path(path).is_file():
            raise SagError(f"--ckpt_path {path} is no file")
        try:
            loaded = torch.load(path, map_location=map_location or "cpu", weights_only=True)
        except Exception as error:
            reason = str(error).splitlines()[0]
            raise SagError(f"--ckpt_path {path} is damaged or no checkpoint of this program: {reason}") from error
        if not isinstance(loaded, dict) or "state_dict" not in loaded:
            raise SagError(f"--ckpt_path {path} is no checkpoint of this program: it holds no state_dict")
        return loaded
