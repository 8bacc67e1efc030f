"""The trained run that comes with the package, for whoever has trained none."""

from __future__ import annotations

from pathlib import Path

from sag.errors import SagError

FOLDER = Path(__file__).parent / "trained"
"""Where it lies: a folder as any run leaves it, with config.fit.yaml and checkpoints/last.ckpt."""


def shipped_run() -> Path:
    """The folder of the run that commands use where none is named.

    Raises:
        SagError: this version ships none.
    """
    if not FOLDER.is_dir():
        raise SagError("no trained run ships with this version; name one, such as runs/ablation/mdpc of make ablation")
    return FOLDER
