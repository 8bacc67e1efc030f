"""KID of motions: the kernel distance of the features that Motion FID looks at; ours for motion, not the paper's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from jaxtyping import Float, Int
from torch import Tensor
from torchmetrics.utilities import dim_zero_cat

from sag.errors import SagError
from sag.metrics.fid.clip_metric import ClipMetric
from sag.metrics.fid.clips import (
    ClipEncoders,
    ClipFeatures,
    check_same_encoders,
    clip_features,
    grouped,
    motions_of,
    picked,
)
from sag.metrics.fid.kernel import kernel_distance
from sag.metrics.sides import SIDES, Real

_GOLDEN = 0.6180339887498949
"""Multiples of it, less their whole part, are spread evenly whatever their number."""

_MOST = 2000
"""Motions of a side that are compared at most, by default."""


def motion_kid(generated_features: ClipFeatures, real_features: ClipFeatures, most: int = _MOST) -> dict[str, Tensor]:
    """KID of features that `clip_features` made, as short, mid, long and average; see `MotionKID`.

    Args:
        generated_features: of generated motions.
        real_features: of real ones, not necessarily as many; motion i of both sides is taken to continue window i.
        most: motions of a side that are compared at most.

    Raises:
        SagError: the sides hold features of different encoders, or fewer than two motions.

    Example:
        >>> import torch
        >>> real = {(16, n): torch.randn(50, 64 // n, 4, generator=torch.manual_seed(n)) for n in (2, 8, 32)}
        >>> bool(motion_kid({key: features + 1 for key, features in real.items()}, real)["average"] > 0.5)
        True
    """
    check_same_encoders("Motion KID", generated_features, real_features)
    keys, sides = list(real_features), []
    for side in (generated_features, real_features):
        places = torch.arange(motions_of(side))
        chosen = _spread(places, most)
        sides.append((_one_clip_each(side, keys, places)[chosen], places[chosen]))
    return _kid(keys, *sides)


class MotionKID(ClipMetric):
    """KID of generated motions against real ones, on the features of Motion FID. Ours for motion.

    For each of three encoders and six clip lengths the unbiased squared maximum mean discrepancy under the kernel
    k(x, y) = (x.y / d + 1)^3 (Binkowski et al., ICLR 2018), see `kernel_distance`:

    KID = mean of k(g_i, g_j) + mean of k(r_i, r_j) - 2 mean of k(g_i, r_j), each over pairs of windows i != j

    where g_i and r_i are features of the generated and the true motion of window i; averaged into `short`, `mid`,
    `long` and `average` as Motion FID is. Both continue one given frame, so they are alike, and pairs of one window
    are left out across the sides as they are within a side: otherwise the figure would lie too low by c / N. True
    motions against themselves are at 0. Unlike Motion FID it does not depend on the number of motions, which may
    differ between the sides, and it assumes no Gaussian. It may be negative where there is nothing to tell apart.

    Clips of one motion are alike, and pairs of them would bias the mean upwards: so each motion gives one clip of
    each length, in turn from every place. Memory is bounded: beyond `most` motions of a side those are kept that a
    fixed rule spreads evenly over the data set, 18 d numbers each. Windows of one recording are alike too, within
    a side and across; that is left in.

    Reacts to poses and paths that true motions do not have, and to a lack of variety. Blind to the scene, to where a
    motion starts, to the given frame, and nearly so to jitter.

    Args:
        encoders: see `ClipEncoders`.
        root: place of the root joint.
        most: motions of a side that are kept at most.
        reset_real: whether `reset` forgets the real side too; without it one pass over the true motions will do.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.fid.kid import MotionKID
        >>> from sag.models.erd import MotionEncoders
        >>> metric = MotionKID(MotionEncoders("gta_im_19", width=0.01), root=12)
        >>> draw = torch.manual_seed(0)
        >>> metric.update(torch.randn(8, 65, 19, 3, generator=draw), real=True)
        >>> metric.update(torch.randn(8, 65, 19, 3, generator=draw), real=False)
        >>> abs(float(metric.compute()["average"])) < 0.01
        True
    """

    plot_lower_bound = None
    title = "Motion KID"
    most: Tensor

    def __init__(
        self, encoders: ClipEncoders, root: int, most: int = _MOST, reset_real: bool = True, **options: Any
    ) -> None:
        super().__init__(encoders, root, reset_real, **options)
        if most < 2:
            raise SagError(f"Motion KID must keep at least 2 motions of a side, not {most}")
        self.add_state("most", torch.tensor(most), dist_reduce_fx="max")  # a state, or collections share others' clips
        self._counted = dict.fromkeys(SIDES, 0)
        for side in SIDES:
            self.add_state(f"{side}_clips", [], dist_reduce_fx="cat")
            self.add_state(f"{side}_index", [], dist_reduce_fx="cat")
        self._begin()

    def update(
        self,
        joints: Float[Tensor, "b t j 3"],
        real: Real,
        index: Int[Tensor, " b"] | None = None,
    ) -> None:
        """Adds motions to the sides they are on.

        Args:
            joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
            real: whether these are true motions, for all or for each.
            index: place of each motion's window in the data set, the same on both sides. Motions of one index are not
                compared. It decides on clips and on what is kept too, so that batches, order and processes make no
                difference; counted on for each side in each process when not given.

        Raises:
            SagError: another number of frames or joints, or a coordinate that is not finite.
        """
        self.update_features(clip_features(self.encoders, joints, self.root), real, index)

    def update_features(self, features: ClipFeatures, real: Real, index: Int[Tensor, " b"] | None = None) -> None:
        """Adds motions of which `clip_features` made the features already.

        Args:
            features: by (encoder, length).
            real: whether these are true motions, for all or for each.
            index: see `update`.

        Raises:
            SagError: features that the metric's own encoders do not make.
        """
        for side, chosen in self._given(features, real).items():
            found = picked(features, chosen)
            places = self._count_on(side, motions_of(found)) if index is None else index[chosen]
            self._keep(side, _one_clip_each(found, self.keys, places), places)

    def compute(self) -> dict[str, Tensor]:
        """KID as short, mid, long and average.

        Raises:
            SagError: a side has fewer than two motions, or all of one index.
        """
        real, generated = (self._kept(side) for side in SIDES)
        found = self._apart() or _kid(self.keys, generated, real)
        if not self._batch_alone and min(len(index.unique()) for _, index in (real, generated)) < 2:
            raise SagError("Motion KID compares motions of different index, and a side has one index only; give more")
        return found

    def reset(self) -> None:
        """Forgets the generated motions, and the real ones unless `reset_real` is False."""
        super().reset()
        self._begin()
        if not self._batch_alone:
            self._counted = {"real": 0 if self.reset_real else self._counted["real"], "generated": 0}

    def _begin(self) -> None:
        """Gives each side clips of no motion, so that processes without any have something to send of that shape."""
        for side in SIDES:
            if not getattr(self, f"{side}_clips"):
                empty = torch.zeros(0, len(self.keys), self.encoders.dimension, dtype=torch.float64)
                setattr(self, f"{side}_clips", [empty.to(self.device)])
                setattr(self, f"{side}_index", [torch.zeros(0, dtype=torch.long, device=self.device)])

    def _count_on(self, side: str, motions: int) -> Int[Tensor, " {motions}"]:
        """Places of motions that came without any."""
        first = self._counted[side]
        self._counted[side] += motions
        return torch.arange(first, first + motions)

    def _keep(self, side: str, clips: Tensor, index: Tensor) -> None:
        """Adds clips of motions to a side, and drops those that are more than it may hold."""
        self._add(side, "motions", len(clips))
        known, places = self._kept(side)
        clips, places = torch.cat([known, clips.double()]), torch.cat([places, index.to(clips.device).long()])
        chosen = _spread(places, int(self.most))
        setattr(self, f"{side}_clips", [clips[chosen]])
        setattr(self, f"{side}_index", [places[chosen]])

    def _kept(self, side: str) -> tuple[Float[Tensor, "n k d"], Int[Tensor, " n"]]:
        clips, places = dim_zero_cat(getattr(self, f"{side}_clips")), dim_zero_cat(getattr(self, f"{side}_index"))
        chosen = _spread(places, int(self.most))
        return clips[chosen], places[chosen]


def _one_clip_each(
    features: ClipFeatures, keys: Sequence[tuple[int, int]], index: Int[Tensor, " b"]
) -> Float[Tensor, "b k d"]:
    """One clip of each motion for each of k encoders and lengths, in turn from every place."""
    device = features[keys[0]].device
    motions, index = torch.arange(motions_of(features), device=device), index.to(device)
    return torch.stack([features[key][motions, index % features[key].shape[1]] for key in keys], dim=1)


def _spread(index: Int[Tensor, " n"], most: int) -> Int[Tensor, " kept"]:
    """Which motions to keep, at most so many, spread evenly over a data set by their places in it alone."""
    if len(index) <= most:
        return torch.arange(len(index), device=index.device)
    return (index.double() * _GOLDEN % 1).argsort(stable=True)[:most]


def _kid(
    keys: Sequence[tuple[int, int]], generated: tuple[Tensor, Tensor], real: tuple[Tensor, Tensor]
) -> dict[str, Tensor]:
    """KID of both sides' clips (n, k, d) and the indices of their windows (n)."""
    (made, own), (true, other) = generated, real
    return grouped({key: kernel_distance(made[:, k], true[:, k], (own, other)) for k, key in enumerate(keys)})
