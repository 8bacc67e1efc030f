"""Motion FID: the Fréchet distance of motion clips in the features of recurrent encoders (paper, 4.2)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor
from torchmetrics import Metric

from sag.errors import SagError
from sag.metrics.clips import GROUPS, LENGTHS, ClipEncoders, clips_by_longest
from sag.metrics.frechet import frechet_distance
from sag.types import FRAMES


class ClipDistance(NamedTuple):
    """One of the 18 distances.

    Attributes:
        distance: Fréchet distance.
        dimension: size of the features.
        real: clips on the real side.
        generated: clips on the generated side.
    """

    distance: float
    dimension: int
    real: int
    generated: int


class MotionFID(Metric):
    """Motion FID of generated motions against real ones.

    Three encoders, trained to predict the next frame of clips of 16, 32 and 64 frames, see the disjoint clips of 2,
    4, ..., 64 frames of both sets: 18 Fréchet distances. `short` is their mean over clips of 2 and 4 frames, `mid`
    of 8 and 16, `long` of 32 and 64, `average` the mean of these three. Plain numbers: the paper names no factor,
    and only distances under the same encoders compare. They also shrink as sets grow: compare sets of one size.

    State is sums in float64, no lists of features. The encoders are no part of `state_dict`.

    Args:
        encoders: see `ClipEncoders`.
        root: place of the root joint.
        reset_real: whether `reset` forgets the real side too; without it one pass over the true motions will do.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics import MotionFID
        >>> from sag.models.erd import MotionEncoders
        >>> metric = MotionFID(MotionEncoders("gta_im_19", width=0.01), root=12)
        >>> motions = torch.randn(8, 65, 19, 3, generator=torch.manual_seed(0))
        >>> metric.update(motions, real=True)
        >>> metric.update(motions, real=False)
        >>> {name: round(float(distance), 5) for name, distance in metric.compute().items()}
        {'short': 0.0, 'mid': 0.0, 'long': 0.0, 'average': 0.0}
    """

    higher_is_better = False
    is_differentiable = False
    full_state_update = False
    plot_lower_bound = 0.0

    def __init__(self, encoders: ClipEncoders, root: int, reset_real: bool = True, **options: Any) -> None:
        super().__init__(**options)
        self._encoders = (encoders,)  # in a tuple, or every checkpoint of a run would carry their weights
        self.root = root
        self.reset_real = reset_real
        self._keys = [(frames, length) for frames in encoders.frames for length in LENGTHS]
        d = encoders.dimension
        for side in ("real", "generated"):
            for name, shape in (("count", ()), ("sum", (d,)), ("products", (d, d))):
                zeros = torch.zeros(len(self._keys), *shape, dtype=torch.float64)
                self.add_state(f"{side}_{name}", zeros, dist_reduce_fx="sum")

    @property
    def encoders(self) -> ClipEncoders:
        """What makes features of clips."""
        return self._encoders[0]

    @property
    def has_real(self) -> bool:
        """Whether the real side has motions, which `reset_real=False` keeps from epoch to epoch."""
        return bool(self._side("real")[0].any())

    def update(self, joints: Float[Tensor, "b t j 3"], real: bool) -> None:
        """Adds motions to one side.

        Args:
            joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
            real: whether these are true motions.

        Raises:
            SagError: another number of frames or joints, or a coordinate that is not finite.
        """
        self._check(joints)
        added = self._moments(joints[:, 1:])
        side = "real" if real else "generated"
        for name, value in zip(("count", "sum", "products"), added):
            setattr(self, f"{side}_{name}", getattr(self, f"{side}_{name}") + value)

    def compute(self) -> dict[str, Tensor]:
        """Motion FID as short, mid, long and average.

        Raises:
            SagError: a side has fewer than two clips.
        """
        return _grouped({key: found.distance for key, found in self._distances().items()})

    def distances(self) -> dict[tuple[int, int], ClipDistance]:
        """All 18 distances by (frames the encoder was trained on, frames of the clips), with d and N.

        Raises:
            SagError: a side has fewer than two clips.
        """
        with self.sync_context():
            return self._distances()

    def share_real(self, other: MotionFID) -> None:
        """Takes over the real side of a metric with the same encoders, as it stands now."""
        self.real_count, self.real_sum, self.real_products = other._side("real")

    def reset(self) -> None:
        """Forgets the generated motions, and the real ones unless `reset_real` is False."""
        kept = None if self.reset_real else self._side("real")
        super().reset()
        if kept is not None:
            self.real_count, self.real_sum, self.real_products = kept

    def _side(self, side: str) -> tuple[Tensor, Tensor, Tensor]:
        return tuple(getattr(self, f"{side}_{name}") for name in ("count", "sum", "products"))  # type: ignore

    def _check(self, joints: Tensor) -> None:
        wanted = (FRAMES, self.encoders.joints)
        if joints.shape[1:3] != wanted:
            found = f"{joints.shape[1]} frames of {joints.shape[2]} joints"
            raise SagError(
                f"Motion FID needs {wanted[0]} frames of {wanted[1]} joints, as its encoders do, not {found}"
            )
        if not joints.isfinite().all():
            raise SagError("Motion FID was given motions with coordinates that are not finite; leave such motions out")

    @torch.no_grad()
    def _moments(self, generated: Tensor) -> list[Tensor]:
        """Count, sum and sum of outer products of the features of these motions, stacked over the 18 keys."""
        self.encoders.to(generated.device)
        features: dict[tuple[int, int], list[Tensor]] = {key: [] for key in self._keys}
        for longest, clips in clips_by_longest(generated, self.root).items():
            lengths = [length for length in LENGTHS if length <= longest]
            for key, found in self.encoders.features(clips, lengths).items():
                features[key].append(found)
        wide = [torch.cat(features[key]).double() for key in self._keys]
        counts = torch.tensor([float(len(x)) for x in wide], dtype=torch.float64, device=generated.device)
        return [counts, torch.stack([x.sum(0) for x in wide]), torch.stack([x.T @ x for x in wide])]

    def _distances(self) -> dict[tuple[int, int], ClipDistance]:
        real, generated = self._side("real"), self._side("generated")
        for name, side in (("real", real), ("generated", generated)):
            if side[0].min() < 2:
                raise SagError(f"Motion FID needs at least 2 {name} motions, it was given {int(side[0].min())}")
        found = {}
        for index, key in enumerate(self._keys):
            moments = [_mean_and_covariance(*(x[index] for x in side)) for side in (real, generated)]
            distance = float(frechet_distance(*moments[0], *moments[1]))
            sizes = (int(side[0][index]) for side in (real, generated))
            found[key] = ClipDistance(distance, real[1].shape[1], *sizes)
        return found


def motion_fid_floor(
    encoders: ClipEncoders, joints: Float[Tensor, "b t j 3"], sequence: Int[Tensor, " b"], root: int
) -> dict[str, Tensor]:
    """Motion FID between two halves of the real motions: what a perfect generator could reach.

    Halves are made of whole sequences, every other one, since the windows of one sequence overlap. They hold half
    as many motions as the set, so the floor of the whole set lies a little lower.

    Args:
        encoders: see `ClipEncoders`.
        joints: 65 frames, metres, camera frame of frame 0.
        sequence: the recording of each motion.
        root: place of the root joint.

    Raises:
        SagError: fewer than two sequences.

    Example:
        >>> import torch
        >>> from sag.metrics import motion_fid_floor
        >>> from sag.models.erd import MotionEncoders
        >>> motions = torch.randn(16, 65, 19, 3, generator=torch.manual_seed(0))
        >>> sequence = torch.arange(4).repeat_interleave(4)
        >>> floor = motion_fid_floor(MotionEncoders("gta_im_19", width=0.01), motions, sequence, root=12)
        >>> bool(floor["average"] > 0)
        True
    """
    rank = torch.unique(sequence, return_inverse=True)[1]
    if not len(rank) or rank.max() < 1:
        raise SagError("the floor of Motion FID needs real motions of at least 2 sequences to split them in halves")
    metric = MotionFID(encoders, root)
    for half in (0, 1):
        for chunk in joints[rank % 2 == half].split(256):
            metric.update(chunk, real=half == 0)
    return metric.compute()


def _mean_and_covariance(count: Tensor, total: Tensor, products: Tensor) -> tuple[Tensor, Tensor]:
    mean = total / count
    return mean, (products - count * mean.outer(mean)) / (count - 1)


def _grouped(distances: Mapping[tuple[int, int], float]) -> dict[str, Tensor]:
    """Short, mid and long over encoders and two clip lengths each, and the mean of the three."""
    found = {
        name: torch.tensor([d for (_, length), d in distances.items() if length in lengths], dtype=torch.float64).mean()
        for name, lengths in GROUPS.items()
    }
    return {**found, "average": torch.stack(list(found.values())).mean()}
