"""Another cut of the same picture, where a camera that stands still would look after a person who walks on."""

from __future__ import annotations

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from sag.geometry.camera import NEAREST, project, recentred
from sag.types import Scene


def offset_to(scene: Scene, point: Float[Tensor, "b 3"]) -> Int[Tensor, "b 2"]:
    """Whole pixels (right, down) by which the picture must move for `point` to come to its centre.

    Whole ones, so that nothing is resampled: colours are not blurred, depths of near and far things are not mixed, and
    a person who stands still has the very same picture. The point is then at most half a pixel off the centre.

    Args:
        scene: the picture and its camera.
        point: metres, camera frame.

    Example:
        >>> import torch
        >>> from sag.geometry.panning import offset_to
        >>> from sag.types import Scene
        >>> camera = torch.tensor([[[100.0, 0, 64], [0, 100, 36], [0, 0, 1]]])
        >>> blank = torch.zeros(1, 36 * 2, 64 * 2)
        >>> scene = Scene(blank[:, None].repeat(1, 3, 1, 1), blank, blank > 0, camera)
        >>> offset_to(scene, torch.tensor([[0.4, 0.0, 4.0]])).tolist()
        [[-10, 0]]
    """
    size = (scene.depth.shape[1], scene.depth.shape[2])
    there = recentred(scene.intrinsics, point, size, scale=1.0)
    return (there - scene.intrinsics)[:, :2, 2].round().long()


def in_picture(scene: Scene, point: Float[Tensor, "b 3"]) -> Bool[Tensor, " b"]:
    """Whether a point (metres, camera frame) lies before the camera and within the picture."""
    size = torch.tensor([scene.depth.shape[2], scene.depth.shape[1]], dtype=point.dtype, device=point.device)
    pixel = project(point, scene.intrinsics)
    return (point[:, 2] > NEAREST) & ((pixel >= 0) & (pixel <= size)).all(dim=1)


def panned(scene: Scene, offset: Int[Tensor, "b 2"]) -> Scene:
    """The scene whose picture is moved by whole pixels (right, down), of the same size and in the same camera frame.

    What lies outside the known picture is black, has depth 0 and no person, as in a data set whose crops reach beyond
    the picture. The person in it stays where it was seen.
    """
    shifted = scene.intrinsics.clone()
    shifted[:, :2, 2] += offset
    rows, row_known = _sources(scene.depth.shape[1], offset[:, 1])
    columns, column_known = _sources(scene.depth.shape[2], offset[:, 0])
    known = row_known[:, :, None] & column_known[:, None]
    window = torch.arange(len(offset), device=offset.device)[:, None, None]
    place = (window, rows[:, :, None], columns[:, None])
    image = scene.image.movedim(1, -1)[place] * known[..., None]
    return Scene(image.movedim(-1, 1), scene.depth[place] * known, scene.person[place] & known, shifted)


def _sources(count: int, offset: Int[Tensor, " b"]) -> tuple[Int[Tensor, "b n"], Bool[Tensor, "b n"]]:
    """For each row or column of the moved picture the one that it comes from, and whether there is one."""
    source = torch.arange(count, device=offset.device) - offset[:, None]
    return source.clamp(0, count - 1), (source >= 0) & (source < count)
