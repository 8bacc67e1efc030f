"""The same motion in another place, as far as gravity and the cameras let it be the same."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor

from sag.errors import SagError
from sag.geometry.camera import to_camera, to_world


def relocated(
    joints: Float[Tensor, "b t j 3"],
    root: int,
    feet: Sequence[int],
    world2cam: Float[Tensor, "b 4 4"],
    other_joints: Float[Tensor, "n s j 3"],
    other_world2cam: Float[Tensor, "n 4 4"],
) -> Float[Tensor, "b t j 3"]:
    """Motions as they would be had they started where other people start, before the cameras that see those.

    A motion is turned about the vertical until it heads the same way in the other picture, then moved: its root starts
    above or below the other person's, and its lowest foot stands as high as the other person's lowest foot, so that a
    walker does not sink where somebody sits. Nothing else changes: bones, steps, and what is up. Computed in float64.

    Args:
        joints: metres, camera frame of frame 0.
        root: place of the root joint.
        feet: places of the joints that may stand on the floor.
        world2cam: takes homogeneous world points (metres, z up, column vectors) to the motion's own camera frame.
        other_joints: the people whose places are taken, of whom frame 0 is looked at; metres, the other camera frame.
        other_world2cam: the other camera; one that looks straight down heads nowhere, and the turn is any.

    Returns:
        Metres, camera frame of the other camera; float32, or float64 if the joints are.

    Raises:
        SagError: not as many places as motions.

    Example:
        >>> import torch
        >>> from sag.geometry.relocation import relocated
        >>> ahead = torch.tensor([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]])[None]
        >>> walk = torch.tensor([[[0.0, 0, 3]], [[0, 0, 4]]])[None]
        >>> place = torch.tensor([[2.0, 1, 5]])[None, None]
        >>> relocated(walk, 0, [0], ahead, place, ahead)[0, :, 0].tolist()
        [[2.0, 1.0, 5.0], [2.0, 1.0, 6.0]]
    """
    if len(other_joints) != len(joints):
        raise SagError(f"{len(joints)} motions need as many places and cameras to be moved to, not {len(other_joints)}")
    world, others = to_world(joints.double(), world2cam), to_world(other_joints[:, :1].double(), other_world2cam)
    turn = _azimuth(other_world2cam) - _azimuth(world2cam)
    origin, target = (_standing_place(motion[:, 0], root, feet)[:, None, None] for motion in (world, others))
    moved = torch.einsum("btji,bki->btjk", world - origin, _about_the_vertical(turn)) + target
    return to_camera(moved, other_world2cam).to(torch.promote_types(joints.dtype, torch.float32))


def _standing_place(pose: Tensor, root: int, feet: Sequence[int]) -> Tensor:
    """Under the root, as high as the lowest foot; world frame, metres."""
    return torch.cat([pose[:, root, :2], pose[:, list(feet), 2].amin(1, keepdim=True)], dim=-1)


def _azimuth(world2cam: Tensor) -> Tensor:
    """Direction over the ground in which cameras look, radians."""
    forward = world2cam[:, 2, :3].double()
    return torch.atan2(forward[:, 1], forward[:, 0])


def _about_the_vertical(angle: Tensor) -> Tensor:
    """Rotations about the world's z axis."""
    sine, cosine, zero = angle.sin(), angle.cos(), torch.zeros_like(angle)
    rows = [torch.stack(row, dim=-1) for row in ((cosine, -sine, zero), (sine, cosine, zero), (zero, zero, zero + 1))]
    return torch.stack(rows, dim=-2)
