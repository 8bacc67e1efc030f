"""Foot contact and foot skate: whether feet touch the floor, and whether they slide on it."""

from __future__ import annotations

from abc import ABC
from collections.abc import Sequence
from typing import Any, NamedTuple

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from sag.metrics.checking import check_floor, check_fps, check_joints
from sag.metrics.plotted import PlottedMetric
from sag.metrics.scene.floor_error import ANKLE_HEIGHT

TOLERANCE = 0.02
"""How far above that an ankle may be while its foot counts as touching, metres."""


class Footing(NamedTuple):
    """What feet do on the floor.

    Attributes:
        contact: whether a foot touches the floor.
        speed: of each ankle over the ground from one frame to the next, metres a second.
    """

    contact: Bool[Tensor, "b t feet"]
    speed: Float[Tensor, "b t-1 feet"]


def footing(
    world: Float[Tensor, "b t j 3"],
    floor: Float[Tensor, "b t feet"],
    feet: Sequence[int],
    fps: float,
    ankle_height: float = ANKLE_HEIGHT,
    tolerance: float = TOLERANCE,
) -> Footing:
    """Contact and horizontal speed of feet.

    A foot below the floor touches it too: it slides no less for being sunk.

    Args:
        world: joints in the world frame, metres, z up.
        floor: height of the floor under each foot, metres; where it is not a number, no foot touches it.
        feet: places of the ankles among the joints.
        fps: frames a second.
        ankle_height: height of a standing person's ankle over the floor, metres.
        tolerance: how far above that an ankle may be, metres.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.feet import footing
        >>> world = torch.tensor([[[[0.0, 0, 0.08]], [[0.5, 0, 0.08]], [[0.5, 0, 0.3]]]])
        >>> found = footing(world, torch.zeros(1, 3, 1), feet=[0], fps=2)
        >>> found.contact.flatten().tolist(), found.speed.flatten().tolist()
        ([True, True, False], [1.0, 0.0])
    """
    ankles = world[:, :, list(feet)]
    contact = ankles[..., 2] - floor <= ankle_height + tolerance
    return Footing(contact, ankles[..., :2].diff(dim=1).norm(dim=-1) * fps)


class _Feet(PlottedMetric, ABC):
    """States of contact and skate, which are the same, so that a collection updates them together."""

    slid: Tensor
    planted: Tensor
    touching: Tensor
    frames_over_floor: Tensor

    def __init__(
        self,
        feet: Sequence[int],
        fps: float,
        ankle_height: float = ANKLE_HEIGHT,
        tolerance: float = TOLERANCE,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.feet, self.fps = list(feet), check_fps(self.title, fps)
        self.ankle_height, self.tolerance = ankle_height, tolerance
        self._keep_settings(ankle_height, tolerance, *self.feet)  # not the rate, which `compute` applies to the sums
        for name in ("slid", "planted", "touching", "frames_over_floor"):
            self.add_state(name, torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, world: Float[Tensor, "b t j 3"], floor: Float[Tensor, "b t feet"]) -> None:
        """Adds motions.

        Args:
            world: joints in the world frame, 65 frames, metres, z up.
            floor: height of the floor under each foot, metres, of `known_floor` or `floor_under_feet`; not a number
                where it is not known: frames without any are left out.

        Raises:
            SagError: another number of frames or feet, or a coordinate that is not finite.
        """
        check_joints(self.title, world, max(self.feet) + 1)
        check_floor(self.title, floor, world, self.feet)
        found = footing(world.double(), floor.double(), self.feet, 1.0, self.ankle_height, self.tolerance)
        both = found.contact[:, 1:] & found.contact[:, :-1]
        self.slid = self.slid + (found.speed * both).sum()
        self.planted = self.planted + both.sum()
        self.touching = self.touching + found.contact[:, 1:].any(-1).sum()
        self.frames_over_floor = self.frames_over_floor + (~floor[:, 1:].isnan()).any(-1).sum()


class FootContact(_Feet):
    r"""Share of generated frames in which at least one foot touches the floor.

    A foot touches when its ankle is at most `ankle_height` + `tolerance` above the floor under it. Ours in its
    threshold and in asking for either foot; the field's measures of contact differ in both.

    It reacts to bodies that float, jump or lie, and to a floor that is not where the feet expect it. It is blind to
    sliding, to how deep feet sink (see the floor error), and to everything above the ankles. Neither high nor low is
    good: the ground truth's figure is the aim, since people also sit and stride.

    Args:
        feet: places of the two ankles among the joints.
        fps: frames a second.
        ankle_height: height of a standing person's ankle over the floor, metres.
        tolerance: how far above that an ankle may be while its foot touches, metres.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.feet import FootContact
        >>> world = torch.zeros(1, 65, 19, 3)
        >>> world[:, 33:, [15, 18], 2] = 0.4
        >>> metric = FootContact(feet=[15, 18], fps=30)
        >>> metric.update(world, floor=torch.zeros(1, 65, 2))
        >>> float(metric.compute())
        0.5
    """

    title = "foot contact"
    higher_is_better = None
    plot_upper_bound = 1.0

    def compute(self) -> Tensor:
        """Share of frames in contact.

        Raises:
            SagError: no motion over a known floor was given.
        """
        self._require(self.frames_over_floor, "motion over a known floor")
        return self.touching / self.frames_over_floor


class FootSkate(_Feet):
    r"""Mean horizontal speed of feet while they touch the floor, m/s.

    Over all feet and all steps from frame t - 1 to t in which the foot touches in both; frame 0 counts, so that feet
    that slide away from it do too:

    .. math:: \frac{\sum_{t, f} c_{f, t - 1} c_{f, t} \lVert \Delta x_{f, t} \rVert \cdot fps}
                   {\sum_{t, f} c_{f, t - 1} c_{f, t}}

    Zhang et al. (MANN, SIGGRAPH 2018) and Ling et al. (Motion VAEs, SIGGRAPH 2020) weight the speed by :math:`2 -
    2^{h / H}` with the height h of the toes instead, and average over all frames, so that feet in the air make the
    mean smaller. Ours is a speed of feet that do touch: it can be read in m/s, and not be had by floating, which
    `FootContact` tells beside it. The threshold is tight, as heels rise while a foot still stands on its ball.

    It reacts to feet that slide. It is blind to everything above the ankles (jitter of the hands is nothing to it),
    to feet in the air, and to vertical motion as long as contact stays. Real people have some, as ankles turn while
    feet stand: read it beside the ground truth's. It is NaN where no foot ever
    stays on the floor from one frame to the next: nothing is known of the sliding of feet that float.

    Args:
        feet: places of the two ankles among the joints.
        fps: frames a second.
        ankle_height: height of a standing person's ankle over the floor, metres.
        tolerance: how far above that an ankle may be while its foot touches, metres.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.feet import FootSkate
        >>> world = torch.zeros(1, 65, 19, 3)
        >>> world[:, :, 15, 0] = torch.arange(65) / 30
        >>> metric = FootSkate(feet=[15, 18], fps=30)
        >>> metric.update(world, floor=torch.zeros(1, 65, 2))
        >>> round(float(metric.compute()), 6)
        0.5
    """

    title = "foot skate"
    higher_is_better = False

    def compute(self) -> Tensor:
        """Mean speed of touching feet, m/s; NaN where no foot touches in two frames on end.

        Raises:
            SagError: no motion over a known floor was given.
        """
        self._require(self.frames_over_floor, "motion over a known floor")
        return self.slid / self.planted * self.fps
