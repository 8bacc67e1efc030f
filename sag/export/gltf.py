"""glTF 2.0 in one binary file: a JSON document and the bytes that it points into.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np

COMPONENTS = {"float32": 5126, "uint8": 5121, "uint16": 5123, "uint32": 5125}
"""Number of each type of component."""

SHAPES = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
"""Name of each shape of an element."""

VERTICES, INDICES = 34962, 34963
"""What a buffer view is for, where it is for drawing."""


class GltfDocument:
    """A document that grows entry by entry; what is added is referred to by the number that comes back.

    Args:
        generator: what the file says it was written by.
    """

    def __init__(self, generator: str) -> None:
        self.content: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [{"nodes": []}],
        }
        self._bytes = bytearray()

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """Number of a new entry of a kind, such as `nodes` or `meshes`."""
        entries = self.content.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def show(self, node: int) -> None:
        """Makes a node one of the scene's own."""
        self.content["scenes"][0]["nodes"].append(node)

    def use(self, extension: str) -> None:
        """Names an extension that the document uses and that readers may pass over."""
        used = self.content.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def view(self, content: bytes, target: int | None = None) -> int:
        """Number of a new stretch of bytes."""
        self._bytes += b"\0" * (-len(self._bytes) % 4)
        entry: dict[str, Any] = {"buffer": 0, "byteOffset": len(self._bytes), "byteLength": len(content)}
        self._bytes += content
        return self.add("bufferViews", entry | ({} if target is None else {"target": target}))

    def accessor(
        self, array: np.ndarray, target: int | None = None, bounded: bool = False, normalized: bool = False
    ) -> int:
        """Number of a new array.

        Args:
            array: elements along the first axis; matrices row by row, as numpy has them.
            target: `VERTICES` or `INDICES`, where it is for drawing.
            bounded: tells the least and the greatest of each component, which places and times must.
            normalized: whole numbers stand for shares of the greatest of their type.
        """
        stored = np.ascontiguousarray(array.swapaxes(1, 2) if array.ndim == 3 else array)
        entry: dict[str, Any] = {
            "bufferView": self.view(stored.tobytes(), target),
            "componentType": COMPONENTS[str(array.dtype)],
            "count": len(array),
            "type": SHAPES[array.shape[1:]],
        }
        if bounded:
            entry |= {
                "min": np.atleast_1d(array.min(axis=0)).tolist(),
                "max": np.atleast_1d(array.max(axis=0)).tolist(),
            }
        return self.add("accessors", entry | ({"normalized": True} if normalized else {}))

    def glb(self) -> bytes:
        """The whole file."""
        self._bytes += b"\0" * (-len(self._bytes) % 4)
        document = self.content | {"buffers": [{"byteLength": len(self._bytes)}]}
        text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(self._bytes), b"BIN\0") + self._bytes
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def numbered(triangles: np.ndarray) -> np.ndarray:
    """Numbers of vertices in a row, in two bytes where they fit; the greatest of a type stands for something else."""
    return triangles.ravel().astype(np.uint16 if triangles.max() < np.iinfo(np.uint16).max else np.uint32)


def numbers(values: np.ndarray) -> Sequence[float]:
    """An array as a document writes it."""
    return [float(value) for value in values.ravel()]
