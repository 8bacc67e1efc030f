"""Furniture from primitives: tables, chairs, sofas, beds, shelves, cabinets, plants and lamps.

All lengths in metres, all places in the piece's own frame: see `sag.data.rooms.pieces`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sag.data.rooms.materials import Colour, Material, shade
from sag.data.rooms.pieces import Piece

SEAT_INSET = 0.23
"""How far behind the front edge of a deep seat people sit, metres."""

WOODS: tuple[Colour, ...] = (
    (0.55, 0.36, 0.2),
    (0.72, 0.53, 0.34),
    (0.36, 0.22, 0.13),
    (0.82, 0.7, 0.52),
    (0.9, 0.9, 0.88),
)
FABRICS: tuple[Colour, ...] = (
    (0.2, 0.32, 0.5), (0.62, 0.2, 0.18), (0.35, 0.45, 0.28), (0.75, 0.62, 0.3), (0.45, 0.45, 0.48), (0.5, 0.3, 0.48),
    (0.78, 0.72, 0.64), (0.15, 0.42, 0.42),
)  # fmt: skip


def _wood(rng: np.random.Generator) -> Material:
    colour = WOODS[rng.integers(len(WOODS))]
    painted = min(colour) > 0.8
    return Material(colour) if painted else Material(colour, shade(colour, 0.84), "wood", 0.09)


def _fabric(rng: np.random.Generator) -> Material:
    colour = FABRICS[rng.integers(len(FABRICS))]
    pattern, scale = (("fabric", 0.012), ("stripes", 0.07), ("checks", 0.11), ("fabric", 0.03))[rng.integers(4)]
    return Material(colour, shade(colour, 0.8), pattern, scale)


def table(rng: np.random.Generator) -> Piece:
    """A dining table or a coffee table, square or round."""
    wood = _wood(rng)
    height = float(rng.choice([rng.uniform(0.7, 0.78), rng.uniform(0.38, 0.48)], p=[0.7, 0.3]))
    piece = Piece("table", top=height)
    if rng.random() < 0.25:
        radius = rng.uniform(0.35, 0.6)
        piece.cylinder((0.0, 0.0, height - 0.02), radius, 0.04, wood)
        piece.cylinder((0.0, 0.0, height / 2), 0.05, height - 0.04, wood)
        piece.cylinder((0.0, 0.0, 0.02), 0.5 * radius, 0.04, wood)
        return piece
    depth, width = rng.uniform(0.6, 0.95), rng.uniform(0.9, 1.8)
    piece.box((0.0, 0.0, height - 0.02), (depth, width, 0.04), wood)
    piece.legs((depth / 2 - 0.05, width / 2 - 0.05), height - 0.04, 0.06, wood)
    if rng.random() < 0.6:
        piece.cylinder((0.05, rng.uniform(-0.3, 0.3) * width, height + 0.08), 0.06, 0.16, _fabric(rng))
    return piece


def chair(rng: np.random.Generator) -> Piece:
    """A chair with a back, or a stool."""
    wood, seat = _wood(rng), rng.uniform(0.43, 0.48)
    side = rng.uniform(0.42, 0.48)
    piece = Piece("chair", seats=[(0.0, 0.0, seat)])
    piece.legs((side / 2 - 0.025, side / 2 - 0.025), seat - 0.05, 0.04, wood)
    piece.box((0.0, 0.0, seat - 0.025), (side, side, 0.05), _fabric(rng) if rng.random() < 0.5 else wood)
    if rng.random() < 0.85:
        back = rng.uniform(0.38, 0.5)
        for y in (-1, 1):
            piece.box((0.02 - side / 2, y * (side / 2 - 0.02), seat + back / 2), (0.035, 0.04, back), wood)
        piece.box((0.02 - side / 2, 0.0, seat + 0.72 * back), (0.03, side - 0.06, 0.5 * back), wood)
    return piece


def sofa(rng: np.random.Generator) -> Piece:
    """A sofa for two or three, or an armchair."""
    fabric = _fabric(rng)
    cushion = Material(shade(fabric.colour, 1.15), fabric.colour, fabric.pattern, fabric.scale)
    seats = int(rng.integers(1, 4))
    depth, seat, arm = rng.uniform(0.8, 0.95), rng.uniform(0.4, 0.46), 0.18
    width, back = 0.62 * seats + 2 * arm, rng.uniform(0.76, 0.9)
    piece = Piece("sofa" if seats > 1 else "armchair", against_wall=seats > 1)
    piece.box((0.02, 0.0, 0.16), (depth - 0.04, width - 0.04, 0.2), fabric)
    piece.legs((depth / 2 - 0.08, width / 2 - 0.08), 0.06, 0.05, Material((0.15, 0.12, 0.1)))
    piece.box((-depth / 2 + 0.11, 0.0, back / 2 + 0.04), (0.22, width, back - 0.08), fabric)
    for side in (-1, 1):
        piece.box((0.02, side * (width - arm) / 2, 0.33), (depth - 0.04, arm, 0.54), fabric)
    for y in 0.62 * (np.arange(seats) - (seats - 1) / 2):
        piece.box((0.12, y, (seat + 0.26) / 2), (depth - 0.26, 0.6, seat - 0.26), cushion)
        piece.box((-depth / 2 + 0.27, y, seat + 0.17), (0.12, 0.54, 0.3), cushion)
        piece.seats.append((depth / 2 - SEAT_INSET, float(y), seat))
    return piece


def bed(rng: np.random.Generator) -> Piece:
    """A bed whose headboard stands at a wall; people sit on its foot."""
    wood, sheet, blanket = _wood(rng), Material((0.92, 0.91, 0.88)), _fabric(rng)
    width, length, top = float(rng.choice([0.9, 1.4, 1.6])), rng.uniform(1.95, 2.1), rng.uniform(0.42, 0.52)
    piece = Piece("bed", against_wall=True)
    piece.box((0.0, 0.0, 0.16), (length, width, 0.16), wood)
    piece.legs((length / 2 - 0.05, width / 2 - 0.05), 0.1, 0.07, wood)
    piece.box((0.0, 0.0, (top + 0.24) / 2), (length - 0.04, width - 0.04, top - 0.24), sheet)
    piece.box((0.29, 0.0, top - 0.05), (length - 0.6, width, 0.12), blanket)
    piece.box((-length / 2 - 0.02, 0.0, 0.5), (0.06, width + 0.06, 1.0), wood)
    for y in (-0.25, 0.25) if width > 1 else (0.0,):
        piece.ball((-length / 2 + 0.28, y * width, top + 0.05), (0.36, min(0.6, 0.45 * width + 0.1), 0.16), sheet)
    piece.seats.append((length / 2 - SEAT_INSET, 0.0, top + 0.01))
    return piece


def shelf(rng: np.random.Generator) -> Piece:
    """An open shelf with books."""
    wood = _wood(rng)
    width, depth, height = rng.uniform(0.7, 1.4), rng.uniform(0.28, 0.38), rng.uniform(1.4, 2.1)
    piece = Piece("shelf", against_wall=True, top=1.15)
    for y in (-1, 1):
        piece.box((0.0, y * (width / 2 - 0.015), height / 2), (depth, 0.03, height), wood)
    piece.box((-depth / 2 + 0.01, 0.0, height / 2), (0.02, width - 0.06, height), wood)
    boards = int(height / 0.38)
    spacing = (height - 0.03) / boards
    for number in range(boards + 1):
        piece.box((0.0, 0.0, 0.015 + number * spacing), (depth, width - 0.06, 0.03), wood)
    for number in range(boards):
        tall, share = rng.uniform(0.5, 0.8) * spacing, rng.uniform(0.3, 0.9) * (width - 0.1)
        aside = rng.uniform(-0.5, 0.5) * (width - 0.1 - share)
        first, second = (FABRICS[i] for i in rng.choice(len(FABRICS), 2, replace=False))
        books = Material(first, second, "books", 0.035)
        piece.box((-0.03, aside, 0.03 + number * spacing + tall / 2), (depth - 0.1, share, tall), books)
    return piece


def cabinet(rng: np.random.Generator) -> Piece:
    """A chest of drawers, a sideboard or a wardrobe."""
    wood = _wood(rng)
    low = rng.random() < 0.65
    width, depth = rng.uniform(0.8, 1.6), rng.uniform(0.4, 0.55)
    height = rng.uniform(0.75, 1.0) if low else rng.uniform(1.7, 2.0)
    piece = Piece("cabinet", against_wall=True, top=height if low else 1.1)
    piece.box((0.0, 0.0, height / 2 + 0.03), (depth, width, height - 0.06), wood)
    piece.box((-0.02, 0.0, 0.03), (depth - 0.08, width - 0.06, 0.06), Material((0.12, 0.1, 0.1)))
    door = Material(shade(wood.colour, 1.1), shade(wood.colour, 0.95), wood.pattern, wood.scale)
    columns, rows = max(2, round(width / 0.5)), 3 if low else 1
    wide, tall = (width - 0.04) / columns, (height - 0.1) / rows
    for column in range(columns):
        for row in range(rows):
            y, z = (column - (columns - 1) / 2) * wide, 0.08 + (row + 0.5) * tall
            piece.box((depth / 2 + 0.008, y, z), (0.016, wide - 0.03, tall - 0.03), door)
            piece.box((depth / 2 + 0.026, y, z), (0.02, 0.12, 0.02), Material((0.25, 0.25, 0.27)))
    return piece


def plant(rng: np.random.Generator) -> Piece:
    """A plant in a pot."""
    pot = Material(FABRICS[rng.integers(len(FABRICS))])
    piece = Piece("plant")
    radius, height = rng.uniform(0.14, 0.2), rng.uniform(0.28, 0.42)
    piece.cylinder((0.0, 0.0, height / 2), radius, height, pot)
    stem = rng.uniform(0.2, 0.6)
    piece.cylinder((0.0, 0.0, height + stem / 2), 0.02, stem, Material((0.3, 0.22, 0.12)))
    leaves = Material((0.13, 0.4, 0.14), (0.3, 0.58, 0.22), "leaves", 0.06)
    for angle in rng.uniform(0.0, 2 * np.pi) + np.arange(4) * np.pi / 2:
        spread = rng.uniform(0.08, 0.14)
        place = (spread * np.cos(angle), spread * np.sin(angle), height + stem + rng.uniform(-0.1, 0.15))
        piece.ball(place, (0.3, 0.3, rng.uniform(0.3, 0.5)), leaves)
    return piece


def lamp(rng: np.random.Generator) -> Piece:
    """A floor lamp."""
    metal = Material((0.2, 0.2, 0.22))
    height = rng.uniform(1.4, 1.75)
    piece = Piece("lamp")
    piece.cylinder((0.0, 0.0, 0.015), 0.15, 0.03, metal)
    piece.cylinder((0.0, 0.0, height / 2), 0.018, height, metal)
    piece.cylinder((0.0, 0.0, height), rng.uniform(0.15, 0.2), 0.28, Material((0.98, 0.92, 0.72)))
    return piece


MAKERS: dict[str, tuple[Callable[[np.random.Generator], Piece], float]] = {
    "table": (table, 0.2),
    "chair": (chair, 0.22),
    "sofa": (sofa, 0.16),
    "bed": (bed, 0.07),
    "shelf": (shelf, 0.09),
    "cabinet": (cabinet, 0.1),
    "plant": (plant, 0.09),
    "lamp": (lamp, 0.07),
}
"""How each kind of piece is made, and its share among the pieces that are tried."""


def random_piece(rng: np.random.Generator) -> Piece:
    """Some piece of furniture."""
    names = list(MAKERS)
    shares = np.array([share for _, share in MAKERS.values()])
    make, _ = MAKERS[names[rng.choice(len(names), p=shares / shares.sum())]]
    return make(rng)
