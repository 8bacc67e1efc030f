"""The pinhole camera, in continuous pixels (see `sag.types`)."""

from __future__ import annotations

import torch
from jaxtyping import Float
from kornia.geometry.camera import project_points, unproject_points
from torch import Tensor

NEAREST = 0.1
"""Points nearer than this (metres), or behind the camera, are projected as if they were here."""


def project(
    points: Float[Tensor, "b ... 3"], intrinsics: Float[Tensor, "b 3 3"], nearest: float = NEAREST
) -> Float[Tensor, "b ... 2"]:
    """Picture coordinates (pixels) of points in the camera frame (metres)."""
    clamped = torch.cat([points[..., :2], points[..., 2:].clamp_min(nearest)], dim=-1)
    return project_points(clamped, _spread(intrinsics, points))


def unproject(
    pixels: Float[Tensor, "b ... 2"], depth: Float[Tensor, "b ..."], intrinsics: Float[Tensor, "b 3 3"]
) -> Float[Tensor, "b ... 3"]:
    """Points in the camera frame (metres) at these picture coordinates and planar depths."""
    return unproject_points(pixels, depth[..., None], _spread(intrinsics, pixels))


def pixel_centres(height: int, width: int, like: Tensor) -> Float[Tensor, "h w 2"]:
    """Picture coordinates of the centre of every pixel, of the dtype and device of `like`."""
    rows = torch.arange(height, dtype=like.dtype, device=like.device) + 0.5
    columns = torch.arange(width, dtype=like.dtype, device=like.device) + 0.5
    return torch.stack(torch.meshgrid(columns, rows, indexing="xy"), dim=-1)


def point_cloud(depth: Float[Tensor, "b h w"], intrinsics: Float[Tensor, "b 3 3"]) -> Float[Tensor, "b h w 3"]:
    """Every pixel of a depth map as a point in the camera frame (metres); the origin where depth is 0."""
    pixels = pixel_centres(depth.shape[1], depth.shape[2], like=depth)
    return unproject(pixels.expand(len(depth), -1, -1, -1), depth, intrinsics)


def recentred(
    intrinsics: Float[Tensor, "b 3 3"],
    point: Float[Tensor, "b 3"],
    size: tuple[int, int],
    scale: float,
) -> Float[Tensor, "b 3 3"]:
    """Intrinsics of the crop of `size` (rows, columns) whose centre sees `point`.

    Args:
        intrinsics: of the whole picture.
        point: camera frame, metres.
        size: rows and columns of the crop.
        scale: pixels of the crop for each pixel of the whole picture.
    """
    scaled = intrinsics.clone()
    scaled[:, :2] = intrinsics[:, :2] * scale
    centre = torch.tensor([size[1] / 2, size[0] / 2], dtype=point.dtype, device=point.device)
    scaled[:, :2, 2] += centre - project(point, scaled)
    return scaled


def to_world(points: Float[Tensor, "b ... 3"], world2cam: Float[Tensor, "b 4 4"]) -> Float[Tensor, "b ... 3"]:
    """Points of the camera frame in the world frame (metres, z up)."""
    rotation, translation = world2cam[:, :3, :3].to(points), world2cam[:, :3, 3].to(points)
    offset = points - translation.view(len(points), *(1,) * (points.dim() - 2), 3)
    return torch.einsum("b...i,bij->b...j", offset, rotation)


def to_camera(points: Float[Tensor, "b ... 3"], world2cam: Float[Tensor, "b 4 4"]) -> Float[Tensor, "b ... 3"]:
    """Points of the world frame (metres, z up) in the camera frame."""
    rotation, translation = world2cam[:, :3, :3].to(points), world2cam[:, :3, 3].to(points)
    turned = torch.einsum("b...i,bji->b...j", points, rotation)
    return turned + translation.view(len(points), *(1,) * (points.dim() - 2), 3)


def _spread(intrinsics: Tensor, points: Tensor) -> Tensor:
    """Camera matrices with the middle dimensions of the points, as kornia wants them."""
    middle = (1,) * (points.dim() - 2)
    return intrinsics.view(len(intrinsics), *middle, 3, 3)
