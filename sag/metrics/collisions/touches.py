"""Touches: which points of a scene lie inside which bones of a motion, without testing all against all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor

from sag.geometry.camera import unproject
from sag.geometry.capsule import Shape, footprints, squared_distance_to_segment
from sag.geometry.cloud import IndexedCloud

_BLOCK = 16
"""Neighbouring pixels that are read together, which is many times faster than one by one."""

_BLOCKS_AT_ONCE = 8192
"""Blocks that are looked at together: few enough for the processor's cache."""

_SLACK = 1e-6
"""Relative widening of a depth interval, above the rounding of float32."""


class Touches(NamedTuple):
    """Pairs of a bone and a point that lies inside it, each once.

    Attributes:
        bone: frame times the number of bones, plus the bone.
        point: place of the point in the flat picture or in the cloud.
        square: of the distance between the point and the bone, square metres.
    """

    bone: Int[Tensor, " k"]
    point: Int[Tensor, " k"]
    square: Float[Tensor, " k"]


def touches_in_depth(
    joints: Float[Tensor, "t j 3"],
    bones: Int[Tensor, "m 2"],
    depth: Float[Tensor, "h w"],
    intrinsics: Float[Tensor, "3 3"],
    radius: float,
    shape: Shape,
) -> Touches:
    """Touches with the points of a depth map, of which only those in the bones' footprints are tested.

    Args:
        joints: metres, camera frame of the depth map.
        bones: places of the two joints of each bone.
        depth: planar z, metres; 0 is no point.
        intrinsics: camera matrix in the pixels of the depth map.
        radius: metres.
        shape: of a bone.
    """
    starts, ends = _ends(joints, bones)
    depth = depth.to(torch.promote_types(depth.dtype, torch.float32))
    near, far = _depths(starts, ends, radius, depth)
    # Looking for the nearest point takes as long as all the rest, and only bones about the camera plane gain by it.
    nearest = float(torch.where(depth > 0, depth, torch.inf).min()) if near.min() < radius else 0.0
    boxes = footprints(starts, ends, radius, intrinsics.double(), (depth.shape[0], depth.shape[1]), nearest)
    rays = _rays(depth, intrinsics)
    found = []
    for bone, pixel, z in _pixels_between(near, far, boxes, depth):
        points = _points(pixel, z, *rays)
        found.append(_inside(bone, pixel, points, starts, ends, radius, shape))
    return Touches(*(torch.cat(parts) for parts in zip(*found)))


def touches_in_cloud(
    joints: Float[Tensor, "t j 3"], bones: Int[Tensor, "m 2"], cloud: IndexedCloud, radius: float, shape: Shape
) -> Touches:
    """Touches with the points of a cloud, of which only those that its index finds near a bone are tested.

    Args:
        joints: metres, frame of the cloud.
        bones: places of the two joints of each bone.
        cloud: the points.
        radius: metres.
        shape: of a bone.
    """
    starts, ends = _ends(joints.cpu(), bones.cpu())
    bone, point = cloud.near_segments(starts, ends, radius)
    found = _inside(bone, point, cloud.points[point], starts, ends, radius, shape)
    return Touches(*(x.to(joints.device) for x in found))


def _ends(joints: Tensor, bones: Tensor) -> tuple[Tensor, Tensor]:
    starts, ends = (joints.double()[:, side].flatten(0, 1) for side in bones.T)
    return starts, ends


def _inside(
    bone: Tensor, point: Tensor, places: Tensor, starts: Tensor, ends: Tensor, radius: float, shape: Shape
) -> Touches:
    """The pairs among these that touch."""
    near_starts, near_ends = starts.index_select(0, bone), ends.index_select(0, bone)
    square = squared_distance_to_segment(places, near_starts, near_ends, shape)
    kept = (square <= radius**2).nonzero()[:, 0]
    return Touches(bone[kept], point[kept], square[kept])


def _depths(starts: Tensor, ends: Tensor, radius: float, like: Tensor) -> tuple[Tensor, Tensor]:
    """Depths between which all of each bone lies, at least the least that is a point."""
    near = (torch.minimum(starts[:, 2], ends[:, 2]) - radius) * (1 - _SLACK)
    far = (torch.maximum(starts[:, 2], ends[:, 2]) + radius) * (1 + _SLACK)
    return near.to(like).clamp_min(torch.finfo(like.dtype).tiny), far.to(like)


def _pixels_between(near: Tensor, far: Tensor, boxes: Tensor, depth: Tensor) -> Iterator[tuple[Tensor, Tensor, Tensor]]:
    """Pixels between two depths in the blocks that each box (see `footprints`) meets: box, place and depth of each."""
    whole = torch.nn.functional.pad(depth.flatten(), (0, -depth.numel() % _BLOCK)).view(-1, _BLOCK)
    boxes_of_blocks, blocks = _blocks(boxes, depth.shape[1])
    for box, block in zip(boxes_of_blocks.split(_BLOCKS_AT_ONCE), blocks.split(_BLOCKS_AT_ONCE)):
        z = whole.index_select(0, block)
        kept = ((z >= near[box, None]) & (z <= far[box, None])).flatten().nonzero()[:, 0]
        row = kept.div(_BLOCK, rounding_mode="floor")
        yield box[row], block[row] * _BLOCK + kept - row * _BLOCK, z.flatten()[kept]


def _blocks(boxes: Tensor, columns: int) -> tuple[Tensor, Tensor]:
    """Blocks of the flat picture that the rows of each box meet, and the box of each; a block once for each box."""
    box, row = _ragged(torch.where(boxes[:, 3] > boxes[:, 2], boxes[:, 1] - boxes[:, 0], 0))
    left = (boxes[box, 0] + row) * columns
    first = (left + boxes[box, 2]).div(_BLOCK, rounding_mode="floor")
    last = (left + boxes[box, 3] - 1).div(_BLOCK, rounding_mode="floor")
    # The end of a row and the beginning of the next may share a block, which is the former's.
    first[1:] = torch.where(row[1:] > 0, torch.maximum(first[1:], last[:-1] + 1), first[1:])
    owner, step = _ragged(last - first + 1)
    return box[owner], first[owner] + step


def _ragged(counts: Tensor) -> tuple[Tensor, Tensor]:
    """Rows 0 .. n - 1 repeated by these counts, and the position of each repetition among its own."""
    owner = torch.arange(len(counts), device=counts.device).repeat_interleave(counts)
    before = counts.cumsum(0) - counts
    return owner, torch.arange(len(owner), device=counts.device) - before[owner]


def _rays(depth: Tensor, intrinsics: Tensor) -> tuple[Tensor, Tensor]:
    """x / z of every column and y / z of every row."""
    size = max(depth.shape)
    diagonal = (torch.arange(size, device=depth.device).double() + 0.5)[:, None].expand(size, 2)
    ones = torch.ones_like(diagonal[:, 0])
    x, y, _ = unproject(diagonal[None], ones[None], intrinsics.double()[None])[0].unbind(-1)
    return x[: depth.shape[1]].contiguous(), y[: depth.shape[0]].contiguous()


def _points(pixel: Tensor, z: Tensor, across: Tensor, down: Tensor) -> Tensor:
    """Points in the camera frame (metres) that pixels of the flat picture see at these depths."""
    row, z = pixel.div(len(across), rounding_mode="floor"), z.double()
    return torch.stack([across[pixel - row * len(across)] * z, down[row] * z, z], dim=-1)
