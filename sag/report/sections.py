"""What the tables of a report show, column by column: the paper's figures first, then ours.

A figure that no row has leaves its column out, and a section without figures its table.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from sag.letters import LETTERS
from sag.report.columns import ALONE, Column, Group
from sag.report.paper import HORIZONS, RADII, PaperFigures


@dataclass(frozen=True)
class Section:
    """A table to be.

    Attributes:
        title: what stands over it; nothing for the first.
        columns: from left to right, the row's name left out.
    """

    title: str
    columns: tuple[Column, ...]


PERCENT, MILLIMETRES = 100.0, 1000.0

FID = Group(
    "Motion FID ↓",
    "FID",
    "FID: Motion FID, lower is better (short: clips of 2 and 4 frames, mid: 8 and 16, long: 32 and 64).",
)
INTERVAL = Group(FID.title, FID.short, "95 %: interval of the average FID, from a bootstrap by rooms or recordings.")
NON_COLLISION = Group(
    "Non-collision ↑",
    "NC",
    "NC: non-collision score with bones of 30, 45 and 60 mm radius, higher is better.",
)

SAME_FEATURES = Group(
    "Of Motion FID's features",
    "FID",
    "N = ∞: Motion FID extrapolated to infinitely many motions. KID: kernel distance of the same features.",
)
FRECHET = Group(
    "Fréchet distance",
    "Fréchet",
    "Fréchet distance: of joint velocities, which shows jitter; of motions together with their scenes.",
)
COLLISIONS = Group(
    "Collisions, by scene",
    "collisions",
    "Collisions: share of frames in a motion's own scene, in other scenes, and their ratio. Its zero is the "
    "blind row's; whoever stands still has none anywhere, so read it beside Motion FID.",
)
INSIDE = Group(
    "Inside furniture or walls",
    "inside",
    "Inside: frames with a bone, and with the root, inside known geometry; mean depth.",
)
FLOOR = Group("Feet off the floor", "feet", "Feet: how far the lower one is below the floor, above it, and either.")
DEPTH = Group(
    "Depth estimate",
    "depth",
    "Depth: error of the depth that a row estimates, and pixels within a factor of 1.25 (δ₁); without D it estimates "
    "none. Read off f: share of the variance of depth that a linear map, fitted in half of the rooms, reads off the "
    "scene feature in the others.",
)
SEES_MORE = Section(
    "What Motion FID cannot see (ours, not the paper's)",
    (
        Column(SAME_FEATURES, "N = ∞", "motion_fid_infinity/average", "lower", detail=1),
        Column(SAME_FEATURES, "KID × 10³", "motion_kid/average", "lower", 1000.0, 2, detail=3),
        Column(FRECHET, "velocity", "velocity_frechet", "lower", floor="velocity_frechet_floor"),
        Column(FRECHET, "scene", "scene_frechet", "lower", floor="scene_frechet_floor"),
        Column(COLLISIONS, "own", "collisions/matched", "lower", digits=3, detail=2),
        Column(COLLISIONS, "other", "collisions/elsewhere", digits=3, detail=2),
        Column(COLLISIONS, "ratio", "collisions/ratio", "lower", digits=2),
        Column(INSIDE, "bone %", "penetration/share", "lower", PERCENT, 1),
        Column(INSIDE, "root %", "penetration/root", "lower", PERCENT, 1, detail=1),
        Column(INSIDE, "depth mm", "penetration/depth", "lower", MILLIMETRES, 1, detail=3),
        Column(FLOOR, "sunk mm", "floor/sunk", "lower", MILLIMETRES, 1, detail=2),
        Column(FLOOR, "floating mm", "floor/floating", "lower", MILLIMETRES, 1, detail=2),
        Column(FLOOR, "error mm", "floor/error", "lower", MILLIMETRES, 1),
        Column(DEPTH, "relative", "depth_error/abs_rel", "lower", digits=3),
        Column(DEPTH, "rmse m", "depth_error/rmse", "lower", digits=2, detail=3),
        Column(DEPTH, "δ₁ %", "depth_error/delta1", "higher", PERCENT, 1, detail=3),
        Column(DEPTH, "read off f %", "depth_probe/explained", "higher", PERCENT, 1, detail=1),
    ),
)
"""Beside the paper's: closer looks at its features, and what they leave out."""

FEET = Group("Feet", "", "Skate: speed of a foot in contact. Contact: frames with a foot on the floor.")
BODY = Group("Body", "", "Bone drift: change of bone lengths.")
DIVERSITY = Group(
    "Diversity of samples",
    "",
    "Deviation, pairwise: of the samples of a window; multimodality: pairwise in Motion FID's features. Figures "
    "without an arrow have no better side; noise is diverse too.",
)
PATH = Group(
    "Best of K: path, m",
    "path (m)",
    "Path, pose: error at each time of whichever of a window's K samples is nearest then.",
)
POSE = Group("Best of K: pose, mm", "pose (mm)")

COMPANIONS = Section(
    "Companions that the field reports (ours, not the paper's)",
    (
        Column(FEET, "skate m/s", "foot_skate", "lower", digits=3),
        Column(FEET, "contact %", "foot_contact", "", PERCENT, 1),
        Column(BODY, "bone drift %", "bone_drift", "lower", PERCENT, 2),
        Column(BODY, "acceleration m/s²", "acceleration", digits=1, detail=2),
        Column(BODY, "jerk m/s³", "jerk", digits=0),
        Column(DIVERSITY, "deviation m", "diversity/deviation", detail=1),
        Column(DIVERSITY, "pairwise m", "diversity/pairwise"),
        Column(DIVERSITY, "multimodality", "diversity/multimodality", detail=1),
        *(
            Column(group, f"{time} s", f"best_of/{what}_{time}", "lower", factor, digits, detail=detail)
            for group, what, factor, digits in ((PATH, "path", 1.0, 3), (POSE, "pose", MILLIMETRES, 0))
            for time, detail in (("0.5", 3), ("1", 2), ("1.5", 3), ("2", 0))
        ),
    ),
)
"""What other work prints of its motions."""


def paper_section(paper: PaperFigures, whole: bool) -> Section:
    """The paper's figures, ours beside the printed ones.

    Args:
        paper: the printed ones.
        whole: all of the printed cells, not the averages alone.
    """
    fid = [
        Column(FID, name, f"motion_fid/{name}", "lower", floor=f"motion_fid_floor/{name}", detail=_detail(name))
        for name in HORIZONS
    ]
    interval = Column(INTERVAL, "95 %", "motion_fid_interval/low", until="motion_fid_interval/high", detail=2)
    clear = [
        Column(NON_COLLISION, _millimetres(name), f"non_collision/{name}", "higher", digits=3, detail=_detail(name))
        for name in RADII
    ]
    letters = (Column(ALONE, letter) for letter in LETTERS.values())
    effort = (Column(ALONE, heading) for heading in ("n", "steps", "min"))
    compared = (*fid, interval, *_printed(fid, paper, whole), *clear, *_printed(clear, paper, whole))
    return Section("", (*letters, *compared, *effort))


def _detail(name: str) -> int:
    return 0 if name == "average" else 1


def _millimetres(name: str) -> str:
    return f"{name} mm" if name.isdigit() else name


def _printed(columns: Iterable[Column], paper: PaperFigures, whole: bool) -> list[Column]:
    """The paper's column for each of ours, or one for the average."""
    printed = [replace(column, paper=True, floor="") for column in columns]
    if not whole:
        return [replace(column, heading="paper") for column in printed if column.heading == "average"]
    return [replace(c, group=replace(c.group, title=f"{c.group.title}, paper on {paper.source}")) for c in printed]
