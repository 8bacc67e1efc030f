"""The protocol of testing, as configs have it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sag.errors import SagError


@dataclass(frozen=True)
class Evaluation:
    """The protocol of testing.

    Attributes:
        seed: of the noise that test and predict draw, and of what is drawn to measure.
        samples: motions that test and predict draw for each window. The first is what the paper's figures judge; all
            of them are needed for diversity and for the best of K.
        collision_frames: about how many frames the non-collision ratio looks at, the same number of every motion,
            at least 1 and at most all; the paper's 10,000.
        collision_unit: what is clear or not; a motion is not when one of its 64 frames is not.
        collision_shape: of a bone; a cylinder has flat ends.
        resamples: of whole rooms or recordings, for the interval around Motion FID; 0 leaves out the interval, and
            with it the extrapolation to infinite N, both of which need all features in memory.
    """

    seed: int = 0
    samples: int = 5
    collision_frames: int = 10_000
    collision_unit: Literal["frame", "motion"] = "frame"
    collision_shape: Literal["capsule", "cylinder"] = "capsule"
    resamples: int = 200

    def __post_init__(self) -> None:
        for name, least in (("samples", 1), ("collision_frames", 1), ("resamples", 0)):
            if getattr(self, name) < least:
                raise SagError(f"evaluation.{name} must be at least {least}, not {getattr(self, name)}")
