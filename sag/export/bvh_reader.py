"""BVH files, read: hierarchy, channels and frames become places of joints."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from sag.errors import SagError
from sag.export.units import UNITS, Unit
from sag.skeleton import Skeleton

AXES = "XYZ"


def bvh_name(name: str) -> str:
    """A joint's name as a BVH file can hold it: in one word."""
    return re.sub(r"[\s{}]+", "_", name)


@dataclass(frozen=True)
class BvhMotion:
    """A motion from a BVH file.

    Attributes:
        names: of the joints, in the order of the file.
        joints: metres, axes of the file.
        fps: frames a second.
    """

    names: tuple[str, ...]
    joints: Float[np.ndarray, "t n 3"]
    fps: float

    def of(self, skeleton: Skeleton) -> Float[np.ndarray, "t j 3"]:
        """The joints of a skeleton, found by their names, in its order; metres.

        Raises:
            SagError: the file lacks one.
        """
        wanted = [bvh_name(name) for name in skeleton.joints]
        if missing := [name for name in wanted if name not in self.names]:
            raise SagError(f"the BVH file has no joint {missing[0]}, which {skeleton.name} has")
        return self.joints[:, [self.names.index(name) for name in wanted]]


@dataclass
class _Node:
    """A joint of the hierarchy with the first of its columns."""

    name: str
    parent: int
    first: int
    offset: np.ndarray = field(default_factory=lambda: np.zeros(3))
    channels: tuple[str, ...] = ()


def read_bvh(path: Path, unit: Unit = "cm") -> BvhMotion:
    """A motion from a BVH file. Places of a joint, where it has channels for them, stand instead of its offset.

    Args:
        path: of the file.
        unit: of its lengths, which no BVH file tells.

    Raises:
        SagError: it is missing or no BVH file of one root.
    """
    try:
        words = iter(path.read_text(encoding="utf-8").split())
        nodes = _hierarchy(words)
        count, rate = _heading(words)
        width = sum(len(node.channels) for node in nodes)
        frames = np.array([float(word) for word in words]).reshape(count, width)
    except OSError as error:
        raise SagError(f"{path} cannot be read ({error.strerror})") from error
    except (ValueError, StopIteration) as error:
        raise SagError(f"{path} is no BVH file of one root ({str(error) or 'it ends too early'})") from error
    return BvhMotion(tuple(node.name for node in nodes), _places(nodes, frames) * UNITS[unit], rate)


def _hierarchy(words: Iterator[str]) -> list[_Node]:
    """The joints of the file, parents before children; ends of bones without a joint are passed over."""
    _expect(words, "HIERARCHY")
    _expect(words, "ROOT")
    nodes: list[_Node] = []
    open_nodes: list[int] = []
    width = 0
    _open(words, nodes, open_nodes, width)
    while open_nodes:
        word = next(words)
        if word == "OFFSET":
            nodes[open_nodes[-1]].offset = np.array([float(next(words)) for _ in AXES])
        elif word == "CHANNELS":
            channels = tuple(next(words) for _ in range(int(next(words))))
            if not all(name[:1] in AXES and name[1:] in ("position", "rotation") for name in channels):
                raise ValueError(f"channels are {' '.join(channels)}")
            nodes[open_nodes[-1]].channels, nodes[open_nodes[-1]].first = channels, width
            width += len(channels)
        elif word == "JOINT":
            _open(words, nodes, open_nodes, width)
        elif word == "End":
            while next(words) != "}":
                pass
        elif word == "}":
            open_nodes.pop()
        else:
            raise ValueError(f"{word[:40]!r} stands in its hierarchy")
    return nodes


def _open(words: Iterator[str], nodes: list[_Node], open_nodes: list[int], width: int) -> None:
    nodes.append(_Node(next(words), open_nodes[-1] if open_nodes else -1, width))
    open_nodes.append(len(nodes) - 1)
    _expect(words, "{")


def _heading(words: Iterator[str]) -> tuple[int, float]:
    """How many frames there are, and how many a second."""
    for word in ("MOTION", "Frames:"):
        _expect(words, word)
    count = int(next(words))
    for word in ("Frame", "Time:"):
        _expect(words, word)
    time = float(next(words))
    if time <= 0:
        raise ValueError(f"its frame time is {time}")
    return count, 1 / time


def _expect(words: Iterator[str], expected: str) -> None:
    found = next(words)
    if found != expected:
        raise ValueError(f"{found[:40]!r} stands where {expected} must")


def _places(nodes: list[_Node], frames: np.ndarray) -> np.ndarray:
    """Places of all joints, in the file's unit."""
    places = np.empty((len(frames), len(nodes), 3))
    turns = np.empty((len(frames), len(nodes), 3, 3))
    for index, node in enumerate(nodes):
        values = frames[:, node.first : node.first + len(node.channels)]
        step = np.tile(node.offset, (len(frames), 1))
        order, angles = "", []
        for name, column in zip(node.channels, values.T):
            if name.endswith("position"):
                step[:, AXES.index(name[0])] = column
            else:
                order += name[0]
                angles.append(column)
        local = Rotation.from_euler(order, np.stack(angles, axis=1), degrees=True).as_matrix() if order else np.eye(3)
        if node.parent < 0:
            places[:, index], turns[:, index] = step, local
        else:
            above = turns[:, node.parent]
            places[:, index] = places[:, node.parent] + (above @ step[..., None])[..., 0]
            turns[:, index] = above @ local
    return places
