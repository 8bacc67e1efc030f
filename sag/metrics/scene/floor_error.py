"""Floor error: how deep feet are in the floor, or how high above it; ours, not the paper's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.metrics.checking import check_floor, check_joints
from sag.metrics.plotted import PlottedMetric
from sag.types import KnownGeometry

ANKLE_HEIGHT = 0.085
"""Height of the ankle joint over the sole of the synthetic rooms' people, metres; other people have other ankles."""


def known_floor(
    world: Float[Tensor, "b t j 3"], feet: Sequence[int], geometry: Sequence[KnownGeometry]
) -> Float[Tensor, "b t f"]:
    """Height of the floor under each foot where the scene is known, metres, world frame.

    Args:
        world: joints, metres, world frame (z up).
        feet: places of the ankles among the joints.
        geometry: of the scene of each motion.

    Raises:
        SagError: not one geometry for each motion.

    Example:
        >>> import torch
        >>> from sag.data.rooms.geometry import FloorPatch, RoomGeometry
        >>> room = RoomGeometry((4.0, 4.0, 2.5), floor=(FloorPatch((0.0, -2.0), (2.0, 2.0), (0.0, 1.0)),))
        >>> standing = torch.tensor([[1.0, 0.0, 0.6], [-1.0, 0.0, 0.1]]).expand(1, 65, 2, 3)
        >>> known_floor(standing, feet=[0, 1], geometry=[room])[0, 0]
        tensor([0.5000, 0.0000], dtype=torch.float64)
    """
    if len(geometry) != len(world):
        raise SagError(f"the floor was asked for under {len(world)} motions but {len(geometry)} scenes were given")
    ground = world[:, :, list(feet), :2].double().cpu().numpy()
    heights = [scene.floor_height(points) for scene, points in zip(geometry, ground)]
    return torch.from_numpy(np.array(heights).reshape(ground.shape[:-1])).to(world.device)


def lowest_foot(
    world: Float[Tensor, "b t j 3"], floor: Float[Tensor, "b t f"], feet: Sequence[int]
) -> Float[Tensor, "b t"]:
    """Height of the lowest ankle over the floor under it at every frame, metres; infinite where no floor is known.

    Args:
        world: joints, metres, world frame (z up).
        floor: height of the floor under each foot, metres, not a number where it is not known.
        feet: places of the ankles among the joints.
    """
    height = world[:, :, list(feet), 2].double() - floor
    return torch.where(height.isnan(), torch.inf, height).amin(-1)


def measured_ankle_height(world: Float[Tensor, "b t j 3"], floor: Float[Tensor, "b t f"], feet: Sequence[int]) -> float:
    """How high the ankle joint of people who stand is over the floor, metres: the median over true motions.

    In most frames of true motion a foot is flat on the floor, so the middle of the lowest foot's heights is its own.
    Give it to `FloorError` for skeletons whose people are not those of the rooms.

    Args:
        world: joints of true motions, metres, world frame (z up).
        floor: height of the floor under each foot, metres, not a number where it is not known.
        feet: places of the ankles among the joints.

    Raises:
        SagError: the floor is known nowhere.

    Example:
        >>> import torch
        >>> standing = torch.tensor([[0.1, 0.0, 0.09], [-0.1, 0.0, 0.09]]).expand(1, 65, 2, 3)
        >>> round(measured_ankle_height(standing, torch.zeros(1, 65, 2), feet=[0, 1]), 3)
        0.09
    """
    heights = lowest_foot(world, floor, feet)
    known = heights[heights.isfinite()]
    if not len(known):
        raise SagError("the ankle's height cannot be measured from motions without a known floor")
    return float(known.median())


class FloorError(PlottedMetric):
    """How far the lowest foot is off the floor under it, on average over generated frames, in metres. Ours.

    With h_t the height of the lowest ankle over the floor under that ankle, less the ankle's own height:

    sunk = mean max(-h_t, 0), floating = mean max(h_t, 0), error = mean |h_t| = sunk + floating

    Reacts to feet below or above the floor, by about as much as they are, on any floor: steps and ramps too. Blind to
    moves along a flat floor, to all joints but the feet, to furniture, and to a foot in the air while the other
    stands. People who jump, or sit without touching the floor, float: print the true motions' value beside it.

    Args:
        feet: places of the two ankles among the joints.
        ankle_height: of the ankle joint over the sole, metres. The default is that of the synthetic rooms' people and
            scales with people: measure another by `measured_ankle_height`.
        options: of `torchmetrics.Metric`.

    Example:
        >>> import torch
        >>> from sag.metrics.scene.floor_error import FloorError
        >>> standing = torch.tensor([[0.1, 0.0, 0.085], [-0.1, 0.0, 0.085]]).expand(1, 65, 2, 3)
        >>> metric = FloorError(feet=[0, 1])
        >>> metric.update(standing, floor=torch.full((1, 65, 2), 0.05))
        >>> {name: round(float(error), 3) for name, error in metric.compute().items()}
        {'sunk': 0.05, 'floating': 0.0, 'error': 0.05}
    """

    higher_is_better = False
    title = "the floor error"

    sunk: Tensor
    floating: Tensor
    frames: Tensor

    def __init__(self, feet: Sequence[int], ankle_height: float = ANKLE_HEIGHT, **options: Any) -> None:
        super().__init__(**options)
        self.feet, self.ankle_height = tuple(feet), ankle_height
        self._keep_settings(ankle_height, *self.feet)
        for name in ("sunk", "floating", "frames"):
            self.add_state(name, torch.zeros((), dtype=torch.float64), dist_reduce_fx="sum")

    def update(self, world: Float[Tensor, "b t j 3"], floor: Float[Tensor, "b t f"]) -> None:
        """Adds motions.

        Args:
            world: joints, 65 frames, metres, world frame (z up); the given frame 0 is left out.
            floor: height of the floor under each foot, metres; not a number where it is not known, as depth may leave
                it: frames without any are left out. Where the scene is known, of `known_floor`.

        Raises:
            SagError: another number of frames or feet, too few joints, or a coordinate that is not finite.
        """
        check_joints(self.title, world, max(self.feet) + 1)
        check_floor(self.title, floor, world, self.feet)
        height = lowest_foot(world[:, 1:], floor[:, 1:], self.feet) - self.ankle_height
        known = height[height.isfinite()]
        self.sunk = self.sunk - known.clamp(max=0).sum()
        self.floating = self.floating + known.clamp(min=0).sum()
        self.frames = self.frames + len(known)

    def compute(self) -> dict[str, Tensor]:
        """The means `sunk`, `floating` and `error`, metres.

        Raises:
            SagError: no frame over a known floor was given.
        """
        self._require(self.frames, "motion over a known floor")
        sunk, floating = self.sunk / self.frames, self.floating / self.frames
        return {"sunk": sunk, "floating": floating, "error": sunk + floating}
