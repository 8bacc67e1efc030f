"""What surfaces look like: colours and procedural patterns, evaluated where a ray meets a surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

Colour = tuple[float, float, float]

Pattern = Callable[[np.ndarray], np.ndarray]
"""(n, 3) places in the piece's own frame, in units of the material's scale -> (n,) share of the second colour."""


@dataclass(frozen=True)
class Material:
    """The look of a surface.

    Attributes:
        colour: red, green and blue in [0, 1].
        second: the colour that the pattern mixes in.
        pattern: a name in `PATTERNS`.
        scale: size of the pattern, metres.
    """

    colour: Colour
    second: Colour = (0.0, 0.0, 0.0)
    pattern: str = "plain"
    scale: float = 1.0


def noise(cells: Int[np.ndarray, "n d"]) -> Float[np.ndarray, " n"]:
    """A fixed pseudo-random number in [0, 1) for each integer cell."""
    mixed = (cells.astype(np.int64) * np.array([73856093, 19349663, 83492791])[: cells.shape[1]]).sum(axis=1)
    mixed = (mixed ^ (mixed >> 13)) * 1274126177 & 0xFFFFFFFF
    return ((mixed ^ (mixed >> 16)) & 0xFFFF) / 65536.0


def _plain(places: np.ndarray) -> np.ndarray:
    return np.zeros(len(places))


def _wood(places: np.ndarray) -> np.ndarray:
    grain = places[:, 0] + places[:, 2] + 0.35 * np.sin(places[:, 1] * 0.5 + np.sin(1.7 * places[:, 0]))
    return 0.5 + 0.3 * np.sin(grain * 6.0) + 0.2 * np.sin(grain * 17.0)


def _planks(places: np.ndarray) -> np.ndarray:
    row = np.floor(places[:, 1])
    board = np.floor(places[:, 0] / 7.0 + 0.37 * row)
    seam = (places[:, 1] - row < 0.05) | (np.abs(places[:, 0] / 7.0 + 0.37 * row - board) < 0.008)
    return np.where(seam, 1.0, 0.55 * noise(np.stack([row, board], axis=1).astype(int)))


def _tiles(places: np.ndarray) -> np.ndarray:
    cell = np.floor(places[:, :2])
    joint = ((places[:, :2] - cell) < 0.04).any(axis=1)
    return np.where(joint, 1.0, 0.25 * noise(cell.astype(int)))


def _checks(places: np.ndarray) -> np.ndarray:
    return np.floor(places + 1e-4).sum(axis=1) % 2


def _stripes(places: np.ndarray) -> np.ndarray:
    return np.floor(places[:, 1]) % 2


def _fabric(places: np.ndarray) -> np.ndarray:
    return noise(np.floor(places).astype(int))


def _books(places: np.ndarray) -> np.ndarray:
    return noise(np.floor(places[:, 1:] * [1.0, 0.12]).astype(int))


def _leaves(places: np.ndarray) -> np.ndarray:
    wave = np.sin(places[:, 0] * 5.1) * np.sin(places[:, 1] * 4.3) * np.sin(places[:, 2] * 4.7)
    return (wave > 0.05).astype(float)


PATTERNS: dict[str, Pattern] = {
    "plain": _plain,
    "wood": _wood,
    "planks": _planks,
    "tiles": _tiles,
    "checks": _checks,
    "stripes": _stripes,
    "fabric": _fabric,
    "books": _books,
    "leaves": _leaves,
}
"""Every pattern by its name."""


class Palette:
    """The materials of many surfaces, asked for at once."""

    def __init__(self, materials: list[Material]) -> None:
        self.colour = np.array([m.colour for m in materials], np.float32)
        self.second = np.array([m.second for m in materials], np.float32)
        self.scale = np.array([m.scale for m in materials], np.float32)
        self.names = sorted({m.pattern for m in materials})
        self.pattern = np.array([self.names.index(m.pattern) for m in materials])

    def __call__(self, which: Int[np.ndarray, " n"], places: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Colour of the materials of these numbers at these places (metres, the piece's own frame)."""
        colour = self.colour[which]
        pattern = self.pattern[which]
        for number, name in enumerate(self.names):
            if name == "plain":
                continue
            here = np.flatnonzero(pattern == number)
            chosen = which[here]
            share = PATTERNS[name](places[here] / self.scale[chosen, None]).astype(np.float32)[:, None]
            colour[here] += share * (self.second[chosen] - colour[here])
        return colour


def shade(colour: Colour, factor: float) -> Colour:
    """A darker (below 1) or lighter (above 1) colour."""
    red, green, blue = (float(np.clip(factor * c, 0.0, 1.0)) for c in colour)
    return red, green, blue
