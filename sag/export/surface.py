"""What a window's picture and depth show of the place: a coloured surface without the person."""

from __future__ import annotations

import io
from dataclasses import dataclass, replace

import numpy as np
import torch
from jaxtyping import Bool, Float, Int, UInt8
from PIL import Image

from sag.data.base import MotionDataModule
from sag.data.cache import DEPTH_UNIT, PERSON
from sag.errors import SagError
from sag.export.gltf import INDICES, VERTICES, GltfDocument, numbered
from sag.export.upright import Upright
from sag.geometry.camera import point_cloud, project
from sag.viewer.surface import empty_picture

MOST_POINTS = 40_000
"""Points of a surface at most; sparser than the depth where that has more."""

GRAZING = 8.0
"""Degrees: a triangle that is seen flatter than this spans two things, one behind the other, and is left out."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A textured mesh.

    Attributes:
        points: metres.
        places: of the points in the picture, from (0, 0) at its top left to (1, 1).
        triangles: points of each, counter-clockwise as the camera sees them.
        picture: colours, where the person is those of what is next to them.
    """

    points: Float[np.ndarray, "v 3"]
    places: Float[np.ndarray, "v 2"]
    triangles: Int[np.ndarray, "f 3"]
    picture: UInt8[np.ndarray, "h w 3"]

    def stood_up(self, upright: Upright) -> Surface:
        """The surface of the camera frame in the frame with Y up."""
        return replace(self, points=upright.from_camera(self.points))


def surface_of(
    data: MotionDataModule,
    window: int,
    seen: tuple[UInt8[np.ndarray, "h w 3"], Float[np.ndarray, "3 3"]] | None = None,
) -> Surface:
    """The place that a window shows, in the camera frame of frame 0, metres.

    Args:
        data: the data set.
        window: its place in the data set.
        seen: its picture and camera, where they are at hand: data sets may have to draw them.

    Raises:
        SagError: the window has no depth.
    """
    cache = data.cache
    person = np.asarray(cache.ids[window]) == PERSON
    depth, intrinsics = np.where(person, 0, cache.depth[window]) * DEPTH_UNIT, cache.intrinsics[window]
    if cache.cloud_row[window] >= 0:
        row = cache.cloud_row[window]
        depth, intrinsics = cache.cloud_depth[row] * DEPTH_UNIT, cache.cloud_intrinsics[row]
    points = _points(depth, intrinsics)
    picture, camera = seen or data.picture_with_camera(window)
    pixels = project(torch.from_numpy(points)[None], torch.from_numpy(camera)[None])[0]
    places = pixels.numpy() / np.array(picture.shape[1::-1])
    known = (points[..., 2] > 0) & (places >= 0).all(axis=-1) & (places <= 1).all(axis=-1)
    step = max(1, int(np.ceil(np.sqrt(known.sum() / MOST_POINTS))))
    points, places, known = (array[::step, ::step] for array in (points, places, known))
    triangles = _triangles(points, known)
    if not len(triangles):
        raise SagError(f"window {window} of {data.name} has no depth to make a surface of; leave --scene out")
    used, triangles = np.unique(triangles, return_inverse=True)
    empty = empty_picture(picture, person)
    return Surface(points.reshape(-1, 3)[used], places.reshape(-1, 2)[used], triangles.reshape(-1, 3), empty)


def _points(depth: Float[np.ndarray, "h w"], intrinsics: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "h w 3"]:
    """Every pixel in the camera frame, metres."""
    return point_cloud(torch.from_numpy(depth)[None], torch.from_numpy(np.float64(intrinsics))[None])[0].numpy()


def _triangles(points: Float[np.ndarray, "h w 3"], known: Bool[np.ndarray, "h w"]) -> Int[np.ndarray, "f 3"]:
    """Two triangles for each square of neighbouring points, without those that are not known or seen too flat."""
    number = np.arange(known.size).reshape(known.shape)
    a, b, c, d = (number[rows, columns].ravel() for rows in _HALVES for columns in _HALVES)
    triangles = np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])
    triangles = triangles[known.ravel()[triangles].all(axis=1)]
    corners = points.reshape(-1, 3)[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = corners.mean(axis=1)
    toward = -(normal * middle).sum(axis=1)
    size = np.linalg.norm(normal, axis=1) * np.linalg.norm(middle, axis=1)
    return triangles[toward > np.sin(np.radians(GRAZING)) * size]


_HALVES = (slice(None, -1), slice(1, None))
"""Each point of a row and its neighbour."""


def add_surface(document: GltfDocument, surface: Surface) -> int:
    """Number of the node of a surface in a document; it shines by itself, as its colours hold the light already."""
    content = io.BytesIO()
    Image.fromarray(surface.picture).save(content, "JPEG", quality=90)
    image = document.add("images", {"bufferView": document.view(content.getvalue()), "mimeType": "image/jpeg"})
    sampler = document.add("samplers", {"magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071})
    texture = {"index": document.add("textures", {"source": image, "sampler": sampler})}
    colour = {"baseColorTexture": texture, "metallicFactor": 0.0, "roughnessFactor": 1.0}
    material = {"name": "scene", "pbrMetallicRoughness": colour, "doubleSided": True}
    document.use("KHR_materials_unlit")
    number = document.add("materials", material | {"extensions": {"KHR_materials_unlit": {}}})
    attributes = {
        "POSITION": document.accessor(surface.points.astype(np.float32), VERTICES, bounded=True),
        "TEXCOORD_0": document.accessor(surface.places.astype(np.float32), VERTICES),
    }
    indices = document.accessor(numbered(surface.triangles), INDICES)
    primitive = {"attributes": attributes, "indices": indices, "material": number}
    mesh = document.add("meshes", {"name": "scene", "primitives": [primitive]})
    return document.add("nodes", {"name": "scene", "mesh": mesh})
