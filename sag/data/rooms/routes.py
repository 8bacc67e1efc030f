"""Ways through a room: the cheapest path over the walking grid, rounded off."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from sag.data.rooms.grid import CELL, CLEARANCE, HIGHEST_STEP
from sag.data.rooms.room import Room

SPACING = 0.05
"""Between the points of a route, metres."""

LEAST_CLEARANCE = CLEARANCE - 0.05
"""What rounding off must leave, metres."""

COMFORT = 0.6
"""People who have room stay this far from obstacles, metres."""

EDGE = 0.25
"""Nearer than this to a change of level (metres) people go straight across, not along it."""


class Router:
    """Finds ways through one room."""

    def __init__(self, room: Room) -> None:
        self.room = room
        self._cells = np.argwhere(room.grid.free)
        self._number = np.full(room.grid.free.shape, -1)
        self._number[tuple(self._cells.T)] = np.arange(len(self._cells))
        self._graph = self._connected()
        self.points = room.grid.points[room.grid.free]

    def _connected(self) -> csr_array:
        grid = self.room.grid
        crowded = np.clip((COMFORT - grid.clearance) / (COMFORT - CLEARANCE), 0, 1)
        cost = 1 + 1.5 * crowded + 1.5 * (grid.edge < EDGE)
        rows, columns, lengths = [], [], []
        padded = np.pad(self._number, 1, constant_values=-1)
        for step in ((0, 1), (1, 0), (1, 1), (1, -1)):
            other = padded[self._cells[:, 0] + 1 + step[0], self._cells[:, 1] + 1 + step[1]]
            here = np.flatnonzero(other >= 0)
            a, b = self._cells[here].T, self._cells[other[here]].T
            level = np.abs(grid.height[tuple(a)] - grid.height[tuple(b)]) < HIGHEST_STEP
            rows.append(here[level])
            columns.append(other[here][level])
            lengths.append((CELL * np.hypot(*step) * (cost[tuple(a)] + cost[tuple(b)]) / 2)[level])
        size = (len(self._cells), len(self._cells))
        return coo_array((np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))), size).tocsr()

    def nearest(self, point: Float[np.ndarray, " 2"]) -> int:
        """Number of the walkable cell nearest to a point over the ground."""
        return int(((self.points - point) ** 2).sum(axis=1).argmin())

    def route(self, start: Float[np.ndarray, " 2"], goal: Float[np.ndarray, " 2"]) -> Float[np.ndarray, "n 2"] | None:
        """A smooth way between two places, points `SPACING` apart; None where there is none."""
        first, last = self.nearest(start), self.nearest(goal)
        _, before = dijkstra(self._graph, directed=False, indices=first, return_predecessors=True)
        if first == last or before[last] < 0:
            return None
        cells = [last]
        while cells[-1] != first:
            cells.append(int(before[cells[-1]]))
        way = np.concatenate([start[None], self.points[cells[::-1]][1:-1], goal[None]])
        return self._rounded(_resampled(way))

    def _rounded(self, way: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "m 2"]:
        """The way rounded off as far as obstacles allow; its ends stay."""
        for sigma in (8, 6, 4, 2.5, 1.5):
            smooth = _smoothed(way, sigma)
            if self.room.grid.at(self.room.grid.clearance, smooth).min() > LEAST_CLEARANCE:
                break
        return _resampled(smooth)


def _smoothed(way: Float[np.ndarray, "n 2"], sigma: float) -> Float[np.ndarray, "n 2"]:
    """Gaussian smoothing that leaves both ends where they are."""
    pad = min(len(way) - 1, int(4 * sigma))
    before = 2 * way[0] - way[pad:0:-1]
    after = 2 * way[-1] - way[-2 : -pad - 2 : -1]
    smooth = gaussian_filter1d(np.concatenate([before, way, after]), sigma, axis=0)[pad : pad + len(way)]
    smooth[[0, -1]] = way[[0, -1]]
    return smooth


def _resampled(way: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "m 2"]:
    """The same way with points `SPACING` apart."""
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
    places = np.linspace(0, length[-1], max(int(np.ceil(length[-1] / SPACING)), 2) + 1)
    return np.stack([np.interp(places, length, axis) for axis in way.T], axis=-1)
