"""What metrics of clip features share: two sides, encoders, and a distance of a batch alone."""

from __future__ import annotations

from typing import Any

from jaxtyping import Bool
from torch import Tensor, nan, tensor

from sag.errors import SagError
from sag.metrics.fid.clips import GROUPS, LENGTHS, ClipEncoders, ClipFeatures, motions_of
from sag.metrics.plotted import PlottedMetric

SIDES = ("real", "generated")
"""Prefixes of the names of states."""


class ClipMetric(PlottedMetric):
    """A metric of the clip features of two sets of motions: short, mid, long and average.

    A subclass has `update` and `update_features`, and a `title` that its refusals begin with. The encoders are no part
    of `state_dict`, and are moved to where the motions are.

    Args:
        encoders: see `ClipEncoders`.
        root: place of the root joint.
        reset_real: whether `reset` forgets the real side too; without it one pass over the true motions will do.
        options: of `torchmetrics.Metric`.
    """

    higher_is_better = False
    title = ""

    real_motions: Tensor
    generated_motions: Tensor

    def __init__(self, encoders: ClipEncoders, root: int, reset_real: bool, **options: Any) -> None:
        super().__init__(**options)
        self._encoders = (encoders,)  # in a tuple, or every checkpoint of a run would carry their weights
        self.root = root
        self.reset_real = reset_real
        self.keys = [(frames, length) for frames in encoders.frames for length in LENGTHS]
        self._batch_alone = False
        for side in SIDES:
            self.add_state(f"{side}_motions", tensor(0), dist_reduce_fx="sum")

    @property
    def encoders(self) -> ClipEncoders:
        """What makes features of clips."""
        return self._encoders[0]

    @property
    def has_real(self) -> bool:
        """Whether the real side has motions, which `reset_real=False` keeps from epoch to epoch."""
        return bool(self.real_motions)

    def forward(self, *args: Any, **kwargs: Any) -> dict[str, Tensor]:
        """Adds motions as `update` does, and says the distance between the two sides of this batch alone.

        Every value is NaN when the batch holds fewer than two motions of a side: there is nothing to compare.
        """
        self._batch_alone = True
        try:
            return super().forward(*args, **kwargs)
        finally:
            self._batch_alone = False

    def reset(self) -> None:
        """Forgets the generated motions, and the real ones unless `reset_real` is False."""
        kept = {} if self.reset_real or self._batch_alone else self._real_state()
        super().reset()
        for name, state in kept.items():
            setattr(self, name, state)

    def share_real(self, other: ClipMetric) -> None:
        """Takes over the real side of a metric with the same encoders, as it stands now."""
        self._computed = None
        for name, state in other._real_state().items():
            setattr(self, name, state)

    def _real_state(self) -> dict[str, Any]:
        states = {name: getattr(self, name) for name in self._defaults if name.startswith("real_")}
        return {name: list(state) if isinstance(state, list) else state for name, state in states.items()}

    def _given(self, features: ClipFeatures, real: bool | Bool[Tensor, " b"]) -> dict[str, slice | Tensor]:
        """Which of the motions are on which side, after whatever was computed before is forgotten.

        Raises:
            SagError: features that the metric's own encoders do not make, or no truth value for each motion.
        """
        count = motions_of(features)
        check_features(self.title, features, self.encoders)
        self._computed = None
        self._update_count = max(1, self._update_count)
        if isinstance(real, bool):
            return {"real" if real else "generated": slice(None)}
        if real.shape != (count,):
            raise SagError(
                f"{self.title} was given {len(real)} values of real for {count} motions; give one for each, or one"
            )
        return {"real": real, "generated": ~real}

    def _add(self, side: str, name: str, value: Tensor | int) -> None:
        setattr(self, f"{side}_{name}", getattr(self, f"{side}_{name}") + value)

    def _nothing_to_compare(self) -> dict[str, Tensor] | None:
        """NaN for each value where a side of the batch has fewer than two motions.

        Raises:
            SagError: the metric as a whole has fewer than two motions of a side.
        """
        for side in SIDES:
            count = int(getattr(self, f"{side}_motions"))
            if count < 2 and not self._batch_alone:
                raise SagError(f"{self.title} needs at least 2 {side} motions, it was given {count}")
            if count < 2:
                return {name: tensor(nan, device=self.device).double() for name in (*GROUPS, "average")}
        return None


def check_features(name: str, features: ClipFeatures, encoders: ClipEncoders) -> None:
    """Refuses features that these encoders do not make.

    Raises:
        SagError: a clip length, an encoder or the dimension differs.
    """
    wanted = {(frames, length) for frames in encoders.frames for length in LENGTHS}
    if set(features) != wanted or any(found.shape[-1] != encoders.dimension for found in features.values()):
        raise SagError(
            f"{name} was given features that its encoders do not make, {len(wanted)} sets of {encoders.dimension} "
            "numbers; make them by clip_features with the metric's encoders"
        )
