"""How many points of a depth map lie inside a body's bones, exactly and without testing all against all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.geometry.camera import unproject
from sag.geometry.capsule import footprints, squared_distance_to_segment

_ROWS_AT_ONCE = 1024
"""Pixel rows of footprints that are looked at together: few enough for the processor's cache."""


def collision_counts(
    joints: Float[Tensor, "t j 3"],
    bones: Int[Tensor, "m 2"],
    depth: Float[Tensor, "h w"],
    intrinsics: Float[Tensor, "3 3"],
    radii: Sequence[float],
) -> Int[Tensor, "t r"]:
    """Points of a depth map inside the capsules around the bones, for each frame and radius.

    A point counts once however many bones it touches. Only pixels inside a bone's footprint are tested, and the
    counts are those of all points against all bones. Computed in float64.

    Args:
        joints: metres, camera frame of the depth map.
        bones: places of the two joints of each bone.
        depth: planar z, metres; 0 is no point.
        intrinsics: camera matrix in the pixels of the depth map.
        radii: of the capsules, metres.

    Example:
        >>> import torch
        >>> depth = torch.full((288, 512), 3.0)
        >>> intrinsics = torch.tensor([[400.0, 0, 256], [0, 400, 144], [0, 0, 1]])
        >>> touching_the_wall = torch.tensor([[[0.0, 0.0, 3.0], [0.0, 0.4, 3.0]]])
        >>> collision_counts(touching_the_wall, torch.tensor([[0, 1]]), depth, intrinsics, (0.03, 0.06))
        tensor([[ 476, 1058]])
    """
    joints, intrinsics, widest = joints.double(), intrinsics.double(), max(radii)
    starts, ends = (joints[:, side].flatten(0, 1) for side in bones.T)
    nearest = float(torch.where(depth > 0, depth, torch.inf).min())
    boxes = footprints(starts, ends, widest, intrinsics, (depth.shape[0], depth.shape[1]), nearest)
    near = (torch.minimum(starts[:, 2], ends[:, 2]) - widest).clamp_min(0)
    far = torch.maximum(starts[:, 2], ends[:, 2]) + widest
    places, squares = [], []
    for capsule, pixel in _pixels(boxes, depth.shape[1]):
        z = depth.flatten()[pixel].double()
        kept = ((z > 0) & (z >= near[capsule]) & (z <= far[capsule])).nonzero()[:, 0]
        capsule, pixel = capsule[kept], pixel[kept]
        points = _points(pixel, z[kept], intrinsics, depth.shape[1])
        square = squared_distance_to_segment(points, starts[capsule], ends[capsule])
        kept = (square <= widest**2).nonzero()[:, 0]
        frame = capsule[kept].div(len(bones), rounding_mode="floor")
        places.append(frame * depth.numel() + pixel[kept])
        squares.append(square[kept])
    return _distinct(torch.cat(places), torch.cat(squares), radii, len(joints), depth.numel())


def _pixels(boxes: Tensor, columns: int) -> Iterator[tuple[Tensor, Tensor]]:
    """Every pixel of every box (first and last + 1 row, then column), as box and place in the flat picture."""
    box, row = _ragged(boxes[:, 1] - boxes[:, 0])
    first = (boxes[box, 0] + row) * columns + boxes[box, 2]
    width = boxes[box, 3] - boxes[box, 2]
    for chunk in torch.arange(max(len(box), 1), device=boxes.device).split(_ROWS_AT_ONCE):
        part = slice(int(chunk[0]), int(chunk[-1]) + 1)
        owner, step = _ragged(width[part])
        yield box[part][owner], first[part][owner] + step


def _ragged(counts: Tensor) -> tuple[Tensor, Tensor]:
    """Rows 0 .. n - 1 repeated by these counts, and the position of each repetition among its own."""
    owner = torch.arange(len(counts), device=counts.device).repeat_interleave(counts)
    before = counts.cumsum(0) - counts
    return owner, torch.arange(len(owner), device=counts.device) - before[owner]


def _points(pixel: Tensor, z: Tensor, intrinsics: Tensor, columns: int) -> Tensor:
    """Points in the camera frame (metres) that pixels of the flat picture see at these depths."""
    row = pixel.div(columns, rounding_mode="floor")
    centres = torch.stack([pixel - row * columns, row], dim=-1) + 0.5
    return unproject(centres.double()[None], z[None], intrinsics[None])[0]


def _distinct(places: Tensor, squares: Tensor, radii: Sequence[float], frames: int, pixels: int) -> Tensor:
    """Points for each frame and radius, those of several bones once."""
    hits = [places[squares <= radius**2].unique().div(pixels, rounding_mode="floor") for radius in radii]
    return torch.stack([torch.bincount(hit, minlength=frames) for hit in hits], dim=-1)
