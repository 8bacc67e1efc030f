"""What metrics of clip features share: two sides, encoders, and a distance of a batch alone."""

from __future__ import annotations

from typing import Any

from torch import Tensor, nan, tensor
from torch.nn import Module

from sag.errors import SagError
from sag.metrics.fid.clips import GROUPS, LENGTHS, ClipEncoders, ClipFeatures, motions_of
from sag.metrics.sides import Real, TwoSides


class ClipMetric(TwoSides):
    """A metric of the clip features of two sets of motions: short, mid, long and average.

    A subclass has `update` and `update_features`, and a `title` that its refusals begin with. The encoders are no part
    of `state_dict`, and are moved to where the motions are.

    Args:
        encoders: see `ClipEncoders`.
        root: place of the root joint.
        reset_real: whether `reset` forgets the real side too; without it one pass over the true motions will do.
        options: of `torchmetrics.Metric`.
    """

    def __init__(self, encoders: ClipEncoders, root: int, reset_real: bool, **options: Any) -> None:
        super().__init__(**options)
        self._encoders = (encoders,)  # in a tuple, or every checkpoint of a run would carry their weights
        self.root = root
        self.reset_real = reset_real
        self.keys = [(frames, length) for frames in encoders.frames for length in LENGTHS]
        self._keep_settings(root, reset_real, *identity(encoders))

    @property
    def encoders(self) -> ClipEncoders:
        """What makes features of clips."""
        return self._encoders[0]

    @property
    def has_real(self) -> bool:
        """Whether the real side has motions, which `reset_real=False` keeps from epoch to epoch."""
        return bool(self.real_motions)

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

    def _given(self, features: ClipFeatures, real: Real) -> dict[str, slice | Tensor]:
        """Which of the motions are on which side, after whatever was computed before is forgotten.

        Raises:
            SagError: features that the metric's own encoders do not make, or no truth value for each motion.
        """
        check_features(self.title, features, self.encoders)
        self._computed = None
        self._update_count = max(1, self._update_count)
        return self._chosen(real, motions_of(features))

    def _apart(self) -> dict[str, Tensor] | None:
        """NaN for each value where a side of the batch that `forward` judges has fewer than two motions."""
        if not self._nothing_to_compare():
            return None
        return {name: tensor(nan, device=self.device).double() for name in (*GROUPS, "average")}


def identity(encoders: ClipEncoders) -> list[float]:
    """Numbers that tell encoders from others: the sum of each of their parameters.

    Encoders without parameters are equal to none but themselves, since nothing is known of what they do.
    """
    parameters = list(encoders.parameters()) if isinstance(encoders, Module) else []
    return [float(each.detach().double().sum()) for each in parameters] or [float(id(encoders))]


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
