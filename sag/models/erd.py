"""ERD: encoder-recurrent-decoder networks, whose memory is what Motion FID compares (paper, 4.2).

Sizes are those of Fragkiadaki et al. (ICCV 2015) as its public re-implementations have them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn

from sag.errors import SagError
from sag.files import write_whole
from sag.skeleton import SKELETONS, skeleton_named

FRAMES = (16, 32, 64)
"""Clip lengths that the three encoders of Motion FID are trained on (paper, 4.2)."""

_FORMAT = "sag motion encoders 1"
_NARROWEST = 32
_CONFIG = "configs/methods/erd.yaml"
_AGAIN = f"delete it and train the encoders again with sag fit --config {_CONFIG}"


class ERD(nn.Module):
    """Predicts the next frame of a clip; the state of its second LSTM is the clip's feature.

    Clips are joints in metres relative to the root of the clip's first frame.

    Args:
        joints: joints of a frame.
        width: factor on every hidden size; 1 is 500, 500, LSTM 1000 x 2, 500, 100, and none goes below 32.
    """

    mean: Tensor
    scale: Tensor

    def __init__(self, joints: int, width: float = 1.0) -> None:
        super().__init__()
        half, whole, tenth = (max(_NARROWEST, round(size * width)) for size in (500, 1000, 100))
        self.dimension = whole
        self.embed = nn.Sequential(nn.Linear(joints * 3, half), nn.ReLU(), nn.Linear(half, half))
        self.memory = nn.LSTM(half, whole, num_layers=2, batch_first=True)
        self.step = nn.Sequential(
            nn.Linear(whole, half), nn.ReLU(), nn.Linear(half, tenth), nn.ReLU(), nn.Linear(tenth, joints * 3)
        )
        self.register_buffer("mean", torch.zeros(joints, 3))
        self.register_buffer("scale", torch.ones(joints, 3))

    def set_statistics(self, clips: Float[Tensor, "n t j 3"]) -> None:
        """Takes the mean and deviation of clips (metres, relative to their first root) for the z-score."""
        self.mean.copy_(clips.mean((0, 1)))
        self.scale.copy_(clips.std((0, 1)).clamp_min(0.02))

    def normalised(self, clips: Float[Tensor, "n t j 3"]) -> Float[Tensor, "n t c"]:
        """Clips z-scored, one vector for each frame, in the network's own precision whatever theirs is."""
        return ((clips.to(self.mean.dtype) - self.mean) / self.scale).flatten(2)

    def forward(self, frames: Float[Tensor, "n t c"]) -> Float[Tensor, "n t c"]:
        """The frame after each frame: the last one plus the step that the network foresees; z-scored both."""
        return frames + self.step(self._states(frames))

    def features(self, clips: Float[Tensor, "n t j 3"], lengths: Sequence[int]) -> list[Float[Tensor, "n d"]]:
        """State of the second LSTM after each of these numbers of frames, from a zero initial state."""
        states = self._states(self.normalised(clips))
        return [states[:, length - 1] for length in lengths]

    def _states(self, frames: Tensor) -> Tensor:
        return self.memory(self.embed(frames))[0]


class MotionEncoders(nn.Module):
    """The three ERDs of Motion FID, trained on clips of 16, 32 and 64 frames.

    Args:
        skeleton: name of the skeleton.
        width: factor on the hidden sizes, see `ERD`.
        joints: how many it has; those of `sag.skeleton.SKELETONS` need not tell.
    """

    def __init__(self, skeleton: str, width: float = 1.0, joints: int | None = None) -> None:
        super().__init__()
        self.skeleton = skeleton
        self.joints = len(skeleton_named(skeleton).joints) if joints is None else joints
        self.width = width
        self.frames: tuple[int, ...] = FRAMES
        self.networks = nn.ModuleDict({str(frames): ERD(self.joints, width) for frames in FRAMES})
        self.dimension: int = self.of(FRAMES[0]).dimension

    def of(self, frames: int) -> ERD:
        """The encoder trained on clips of that many frames."""
        network = self.networks[str(frames)]
        assert isinstance(network, ERD)
        return network

    def set_statistics(self, clips: Float[Tensor, "n t j 3"]) -> None:
        """Takes mean and deviation of clips (metres, relative to their first root) for all three."""
        for frames in self.frames:
            self.of(frames).set_statistics(clips)

    def features(
        self, clips: Float[Tensor, "n t j 3"], lengths: Sequence[int]
    ) -> dict[tuple[int, int], Float[Tensor, "n d"]]:
        """Features of the first `length` frames of clips, by (encoder, length), all lengths in one pass.

        Args:
            clips: metres, relative to the root of the clip's first frame.
            lengths: where to read.
        """
        return {
            (frames, length): found
            for frames in self.frames
            for length, found in zip(lengths, self.of(frames).features(clips, lengths))
        }

    def save(self, path: Path, fingerprint: str) -> None:
        """Writes the encoders whole or not at all: temporary name, sync, rename.

        Args:
            path: the file.
            fingerprint: of the data they were trained on.
        """
        content: dict[str, Any] = {
            "format": _FORMAT,
            "skeleton": self.skeleton,
            "joints": self.joints,
            "width": self.width,
            "fingerprint": fingerprint,
            "weights": {name: tensor.detach().cpu() for name, tensor in self.state_dict().items()},
        }
        content["sha256"] = _digest(content)
        write_whole(path, lambda file: torch.save(content, file))

    @classmethod
    def load(cls, path: Path, skeleton: str | None = None, fingerprint: str | None = None) -> MotionEncoders:
        """Encoders from a file, ready to use.

        Args:
            path: the file.
            skeleton: name of the skeleton they must be for, any when None.
            fingerprint: of the data they must have been trained on, any when None.

        Raises:
            SagError: the file is missing, damaged, no file of encoders, or one for another skeleton or data.
        """
        content = _read(path)
        for field, wanted in (("skeleton", skeleton), ("fingerprint", fingerprint)):
            if wanted is not None and content[field] != wanted:
                raise SagError(f"{path} holds encoders for {field} {content[field]!r}, not {wanted!r}; {_AGAIN}")
        name, joints = content["skeleton"], content["joints"]
        known = SKELETONS.get(name)
        if known is not None and len(known.joints) != joints:
            raise SagError(f"{path} holds encoders for {joints} joints, not {len(known.joints)}; {_AGAIN}")
        encoders = cls(name, content["width"], joints)
        encoders.load_state_dict(content["weights"])
        return encoders.eval().requires_grad_(False)


def _read(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise SagError(f"the motion encoders {path} are missing; train them with sag fit --config {_CONFIG}")
    damaged = SagError(f"{path} is damaged or holds no motion encoders; {_AGAIN}")
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
        whole = content["format"] == _FORMAT and content["sha256"] == _digest(content)
    except Exception as error:  # a damaged archive raises whatever the damaged byte makes it raise
        raise damaged from error
    if not whole:
        raise damaged
    return content


def _digest(content: Mapping[str, Any]) -> str:
    """Checksum of every field and of the weights' bytes, since an archive does not notice a flipped bit."""
    fields = {name: value for name, value in content.items() if name not in ("weights", "sha256")}
    digest = hashlib.sha256(repr(sorted(fields.items())).encode())
    for name, tensor in content["weights"].items():
        digest.update(f"{name} {tuple(tensor.shape)}".encode())
        digest.update(tensor.numpy().tobytes())
    return digest.hexdigest()
