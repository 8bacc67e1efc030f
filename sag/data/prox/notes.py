"""What speaks against figures on PROX, if anything."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from sag.data.prox.names import FPS, FrameName
from sag.data.prox.recording import stems
from sag.data.prox.root import Root
from sag.errors import SagError

OFF = 0.1
"""Recordings whose rate differs by more than this share from the nominal one are named."""


def notes_on(root: Root) -> Iterator[str]:
    """What a reader of figures must know of the data they are made on."""
    if root.bodies is None:
        yield (
            "KINECT SKELETONS USED, which tremble and mistake limbs, instead of PROXD's fits: "
            "no --data.init_args.smplx_models"
        )
    if root.sensor.colour.distortion.any():
        yield f"lens distortion in {root.sensor.colour.path} is left out, as PROX's fits leave it out"
    masked = [folder for folder in root.recordings if (folder / "BodyIndexColor").is_dir()]
    if len(masked) < len(root.recordings):
        count = len(root.recordings) - len(masked)
        yield f"{count} recordings have no BodyIndexColor: the person is where the depth camera or the joints put it"
    other = [f"{folder.name} {rate:.1f}" for folder in root.recordings if _differs(rate := _rate(folder))]
    if other:
        yield f"frames are taken as {FPS:g} a second, but {len(other)} recordings have others: {', '.join(other)}"


def _rate(folder: Path) -> float:
    """Frames a second of a recording, by the clock in their names; the nominal rate where it is broken."""
    try:
        seconds = [FrameName.of(stem, str(folder)).seconds for stem in stems(folder / "Color", ".jpg")]
    except SagError:
        return FPS
    span = max(seconds, default=0.0) - min(seconds, default=0.0)
    return (len(seconds) - 1) / span if span > 0 else FPS


def _differs(rate: float) -> bool:
    return abs(rate - FPS) > OFF * FPS
