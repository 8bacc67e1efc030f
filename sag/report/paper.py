"""The paper's figures as printed (Tables 1 to 5), keyed by the names of our rows.

Printed averages are not always the mean of their row (.891 for a mean of .888): these are the printed
cells. "CSGN+M" of Tables 2, 3 and 5 is the row `md`, "CSGN+M+G" is `mdpc`; their figures agree with Table 1.
"""

from __future__ import annotations

from dataclasses import dataclass

HORIZONS = ("short", "mid", "long", "average")
"""Columns of Motion FID: clips of 2 and 4, 8 and 16, 32 and 64 frames, and the mean of the three."""

RADII = ("30", "45", "60", "average")
"""Columns of the non-collision score: radius of the cylinders around the bones in millimetres, and the mean."""

Four = tuple[float, float, float, float]

TABLE_1_MOTION_FID: dict[str, Four] = {
    "none": (92.4, 125.6, 137.8, 118.6),
    "m": (27.6, 33.4, 38.6, 33.1),
    "md": (26.8, 32.2, 37.5, 32.1),
    "mdc": (25.9, 31.0, 35.6, 30.8),
    "mdp": (23.3, 28.4, 34.5, 28.7),
    "mdpc": (22.4, 27.6, 33.7, 27.6),
}
"""GTA-IM, the ablation: Motion FID by `HORIZONS`, lower is better."""

TABLE_1_NON_COLLISION: dict[str, Four] = {
    "m": (0.931, 0.882, 0.851, 0.891),
    "md": (0.941, 0.902, 0.874, 0.902),
    "mdc": (0.948, 0.919, 0.904, 0.923),
    "mdp": (0.956, 0.934, 0.915, 0.938),
    "mdpc": (0.962, 0.943, 0.924, 0.943),
}
"""GTA-IM, the ablation: non-collision score by `RADII`, higher is better."""

TABLE_2: dict[str, Four] = {
    "two_stage": (172.8, 196.5, 210.4, 193.2),
    "hp_gan": (156.6, 176.2, 190.4, 174.4),
    "none": (92.4, 125.6, 137.8, 118.6),
    "md": (26.8, 32.2, 37.5, 32.1),
    "mdpc": (22.4, 27.6, 33.7, 27.6),
}
"""GTA-IM against other methods: Motion FID by `HORIZONS`."""

TABLE_3: dict[str, Four] = {
    "two_stage": (261.5, 276.8, 292.4, 276.9),
    "hp_gan": (214.7, 225.3, 251.7, 230.6),
    "none": (141.5, 160.3, 183.2, 161.6),
    "md": (55.3, 58.4, 62.5, 58.7),
    "mdpc": (52.4, 54.5, 56.9, 54.6),
}
"""PROX against other methods: Motion FID by `HORIZONS`."""

TABLE_4: dict[str, Four] = {
    "md": (0.793, 0.731, 0.692, 0.742),
    "mdp": (0.813, 0.764, 0.733, 0.770),
    "mdpc": (0.831, 0.782, 0.753, 0.792),
}
"""PROX: non-collision score by `RADII`."""


@dataclass(frozen=True)
class Opinion:
    """What people said of a method, on a scale of 1 to 5: mean and standard deviation.

    Attributes:
        scene: does the motion fit the scene.
        human: does the motion look human.
    """

    scene: tuple[float, float]
    human: tuple[float, float]


TABLE_5: dict[str, dict[str, Opinion]] = {
    "gta_im": {
        "none": Opinion((2.66, 0.74), (2.92, 0.84)),
        "md": Opinion((3.26, 0.76), (3.32, 0.73)),
        "mdpc": Opinion((3.56, 0.72), (3.53, 0.68)),
        "ground_truth": Opinion((4.51, 0.49), (4.45, 0.49)),
    },
    "prox": {
        "none": Opinion((2.46, 0.82), (2.52, 0.73)),
        "md": Opinion((3.12, 0.88), (3.23, 0.71)),
        "mdpc": Opinion((3.36, 0.74), (3.32, 0.66)),
        "ground_truth": Opinion((4.13, 0.62), (4.14, 0.61)),
    },
}
"""The user study, by data set."""


@dataclass(frozen=True)
class PaperFigures:
    """The paper's figures on the data set that is nearest to one of ours.

    Attributes:
        source: data set, as a heading says it.
        motion_fid: by row, then `HORIZONS`.
        non_collision: by row, then `RADII`.
        pretrained: whether its rows were trained on other data first.
    """

    source: str
    motion_fid: dict[str, Four]
    non_collision: dict[str, Four]
    pretrained: bool = False

    def cells(self, row: str) -> dict[str, float]:
        """The figures of a row by our names for them, without those that the paper does not print."""
        tables = (("motion_fid", HORIZONS, self.motion_fid), ("non_collision", RADII, self.non_collision))
        return {
            f"{metric}/{column}": value
            for metric, columns, table in tables
            if row in table
            for column, value in zip(columns, table[row])
        }


GTA_IM = PaperFigures("GTA-IM", {**TABLE_2, **TABLE_1_MOTION_FID}, TABLE_1_NON_COLLISION)
PROX = PaperFigures("PROX", TABLE_3, TABLE_4, pretrained=True)


def paper_figures(data: str) -> PaperFigures:
    """The figures to lay beside a data set's: PROX for PROX, GTA-IM for all others."""
    return PROX if "prox" in data.lower() else GTA_IM
