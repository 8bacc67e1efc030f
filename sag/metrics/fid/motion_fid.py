"""Motion FID: the Fréchet distance of motion clips in the features of recurrent encoders (paper, 4.2)."""

from __future__ import annotations

import warnings
from typing import Any, Literal, NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.fid.clip_metric import ClipMetric
from sag.metrics.fid.clips import ClipEncoders, ClipFeatures, check_paired, clip_features, grouped, motions_of, picked
from sag.metrics.frechet import Gaussian
from sag.metrics.sides import SIDES, Real
from sag.types import GENERATED


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


class MotionFID(ClipMetric):
    """Motion FID of generated motions against real ones.

    Three encoders, trained to predict the next frame of clips of 16, 32 and 64 frames, see the disjoint clips of 2,
    4, ..., 64 frames of both sets: 18 Fréchet distances, each

    |m_r - m_g|^2 + tr(C_r + C_g - 2 (C_r^1/2 C_g C_r^1/2)^1/2)

    of the means and covariances of the features. `short` is their mean over clips of 2 and 4 frames, `mid` of 8 and
    16, `long` of 32 and 64, `average` the mean of these three. Plain numbers: the paper names no factor, and only
    distances under the same encoders compare. They also shrink as sets grow, so that only sets of one size compare.

    Reacts to poses and paths that true motions do not have, and to a lack of variety. Blind to the scene, to where a
    motion starts, to the given frame, and nearly so to jitter.

    State is sums in float64, no lists of features: 18 d^2 numbers a side. The encoders are no part of `state_dict`.

    Args:
        encoders: see `ClipEncoders`.
        root: place of the root joint.
        reset_real: whether `reset` forgets the real side too; without it one pass over the true motions will do.
        unequal: what to do about sides of unequal numbers of motions.
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

    title = "Motion FID"

    def __init__(
        self,
        encoders: ClipEncoders,
        root: int,
        reset_real: bool = True,
        unequal: Literal["refuse", "warn", "ignore"] = "refuse",
        **options: Any,
    ) -> None:
        super().__init__(encoders, root, reset_real, **options)
        self.unequal = unequal
        self._known_real: dict[tuple[int, int], Gaussian] = {}
        d = encoders.dimension
        for side in SIDES:
            for name, shape in (("sum", (d,)), ("products", (d, d))):
                zeros = torch.zeros(len(self.keys), *shape, dtype=torch.float64)
                self.add_state(f"{side}_{name}", zeros, dist_reduce_fx="sum")

    def update(self, joints: Float[Tensor, "b t j 3"], real: Real) -> None:
        """Adds motions to the sides they are on.

        Args:
            joints: 65 frames, metres, camera frame of frame 0; the given frame 0 is left out.
            real: whether these are true motions, for all or for each.

        Raises:
            SagError: another number of frames or joints, or a coordinate that is not finite.
        """
        self.update_features(clip_features(self.encoders, joints, self.root), real)

    def update_features(self, features: ClipFeatures, real: Real) -> None:
        """Adds motions of which `clip_features` made the features already.

        Args:
            features: by (encoder, length).
            real: whether these are true motions, for all or for each.

        Raises:
            SagError: features that the metric's own encoders do not make.
        """
        for side, chosen in self._given(features, real).items():
            found = picked(features, chosen)
            wide = [found[key].double().flatten(0, 1) for key in self.keys]
            self._add(side, "motions", motions_of(found))
            self._add(side, "sum", torch.stack([x.sum(0) for x in wide]))
            self._add(side, "products", torch.stack([x.T @ x for x in wide]))

    def compute(self) -> dict[str, Tensor]:
        """Motion FID as short, mid, long and average.

        Raises:
            SagError: a side has fewer than two motions, or one has more than the other.
        """
        return self._apart() or grouped(self._distances())

    def distances(self) -> dict[tuple[int, int], ClipDistance]:
        """All 18 distances by (frames the encoder was trained on, frames of the clips), with d and N.

        Raises:
            SagError: a side has fewer than two motions, or one has more than the other.
        """
        with self.sync_context():
            self._nothing_to_compare()
            d, real, generated = self.encoders.dimension, int(self.real_motions), int(self.generated_motions)
            return {
                key: ClipDistance(float(found), d, *(count * GENERATED // key[1] for count in (real, generated)))
                for key, found in self._distances().items()
            }

    def __getstate__(self) -> dict[str, Any]:
        """Leaves out the roots of the real side, which can be had again."""
        return {**super().__getstate__(), "_known_real": {}}

    def _distances(self) -> dict[tuple[int, int], Tensor]:
        self._mind_unequal()
        return {
            key: self._real(place, key).distance(self._gaussian("generated", place, key))
            for place, key in enumerate(self.keys)
        }

    def _gaussian(self, side: str, place: int, key: tuple[int, int]) -> Gaussian:
        motions, total, products = (getattr(self, f"{side}_{name}") for name in ("motions", "sum", "products"))
        return Gaussian.of_sums(motions * (GENERATED // key[1]), total[place], products[place])

    def _real(self, place: int, key: tuple[int, int]) -> Gaussian:
        """The real side's Gaussian; the one with the root known already if it is the same to the bit."""
        fresh = self._gaussian("real", place, key)
        known = self._known_real.get(key)
        if known is None or not known.same_as(fresh):
            self._known_real[key] = fresh
        return self._known_real[key]

    def _mind_unequal(self) -> None:
        real, generated = int(self.real_motions), int(self.generated_motions)
        if real == generated or self._batch_alone or self.unequal == "ignore":
            return
        sentence = (
            f"{self.title} was given {real} real and {generated} generated motions, and it shrinks as sets grow: "
            "give both sides equally many, or say unequal='warn'"
        )
        if self.unequal == "refuse":
            raise SagError(sentence)
        warnings.warn(sentence.partition(":")[0] + ", so compare it with none of other numbers", stacklevel=2)


def motion_fid_of_features(generated: ClipFeatures, real: ClipFeatures) -> dict[str, Tensor]:
    """Motion FID of features that `clip_features` made; see `MotionFID`.

    Args:
        generated: features of generated motions.
        real: features of as many real ones.

    Raises:
        SagError: the sides differ in what they hold, or have fewer than two motions.

    Example:
        >>> import torch
        >>> features = {(16, length): torch.randn(9, 64 // length, 4) for length in (2, 4, 8, 16, 32, 64)}
        >>> float(motion_fid_of_features(features, features)["average"].round(decimals=6))
        0.0
    """
    check_paired("Motion FID", generated, real)
    sides = ((side[key].flatten(0, 1) for side in (real, generated)) for key in real)
    return grouped({key: Gaussian.of(a).distance(Gaussian.of(b)) for key, (a, b) in zip(real, sides)})
