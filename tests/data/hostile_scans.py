"""Damaged and hostile scans."""

from __future__ import annotations

import struct
from pathlib import Path

import hostile_files as bad
import hostile_traps as trap
import numpy as np
from hostile_files import Damage

SCAN = "scenes/MPH16.ply"

CORNERS = np.array([[-9, 2, -9], [9, 2, -9], [9, 2, 9], [-9, 2, 9]], "<f4")
"""Of a wall before the camera: metres, the scan's frame."""

FACES = [(0, 1, 2), (0, 2, 3)]


def written(
    vertices: int = 4,
    faces: int = 2,
    corners: np.ndarray = CORNERS,
    places: list[tuple[int, ...]] = FACES,
    count: str = "B",
    told: int = 3,
    comment: str = "",
) -> Damage:
    """A scan in bytes.

    Args:
        vertices: how many the header tells.
        faces: how many the header tells.
        corners: the vertices that there are.
        places: the faces that there are.
        count: type of the count of a face's corners.
        told: that count.
        comment: in the header.
    """
    kinds = {"B": "uchar", "I": "uint", "i": "int"}
    real = {"<f4": "float", "<f8": "double"}[corners.dtype.str]
    head = (
        f"ply\nformat binary_little_endian 1.0\n{comment}element vertex {vertices}\n"
        + "".join(f"property {real} {axis}\n" for axis in "xyz")
        + f"element face {faces}\nproperty list {kinds[count]} int vertex_indices\nend_header\n"
    )
    rows = b"".join(struct.pack(f"<{count}{len(face)}i", told, *face) for face in places)
    return bad.replaced(SCAN, head.encode() + corners.tobytes() + rows)


def cut(root: Path) -> None:
    written()(root)
    bad.truncated(SCAN, 0.9)(root)


def changed(place: tuple[int, int], value: float, kind: str = "<f4") -> np.ndarray:
    """The corners with another number somewhere."""
    corners = CORNERS.astype(kind)
    corners[place] = value
    return corners


def with_picture(root: Path) -> None:
    """A whole scan that names a picture beside it, of 3.6 thousand million pixels."""
    written(comment="comment TextureFile texture.png\n")(root)
    (root / "scenes" / "texture.png").write_bytes(trap.png_of(60_000, 60_000))


SCANS = {
    "missing": bad.missing(SCAN),
    "empty": bad.replaced(SCAN, b""),
    "truncated": cut,
    "text": bad.replaced(SCAN, b"<html>404 Not Found</html>"),
    "link_out": bad.linked(SCAN),
    "pipe": bad.pipe(SCAN),
    "header_alone": bad.replaced(SCAN, b"ply\nformat ascii 1.0\nelement vertex 3\n"),
    "a_thousand_million_corners": written(vertices=10**9),
    "more_corners_than_numbers_hold": written(vertices=10**30),
    "fewer_than_no_corners": written(vertices=-4),
    "a_thousand_million_triangles": written(faces=10**9),
    "triangles_of_many_corners": written(count="I", told=1 << 31),
    "triangles_of_fewer_than_no_corners": written(count="i", told=-5),
    "no_triangles": written(faces=0, places=[]),
    "corner_that_is_not_there": written(places=[(0, 1, 2), (0, 2, 99)]),
    "corner_before_the_first": written(places=[(0, 1, 2), (0, 2, -1)]),
    "nan_corner": written(corners=changed((1, 1), np.nan)),
    "infinite_corner": written(corners=changed((1, 1), np.inf)),
    "corner_out_of_the_world": written(corners=changed((1, 1), 1e300, "<f8")),
}
