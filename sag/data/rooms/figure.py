"""The person in the picture: a clothed body around the joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sag.data.cache import PERSON
from sag.data.rooms.lofts import RING, ellipsoid, loft, tapered
from sag.data.rooms.materials import Colour, Material, shade
from sag.data.rooms.surfaces import SurfaceList, Surfaces
from sag.geometry.kinematics import unit
from sag.skeleton import GTA_IM_19

SKINS: tuple[Colour, ...] = ((0.93, 0.76, 0.65), (0.82, 0.62, 0.48), (0.62, 0.43, 0.31), (0.42, 0.28, 0.2))
HAIRS: tuple[Colour, ...] = ((0.12, 0.09, 0.07), (0.32, 0.2, 0.11), (0.66, 0.5, 0.28), (0.5, 0.5, 0.5))
SHIRTS: tuple[Colour, ...] = (
    (0.85, 0.2, 0.18), (0.15, 0.35, 0.7), (0.95, 0.8, 0.2), (0.2, 0.55, 0.3), (0.9, 0.9, 0.9), (0.4, 0.22, 0.5),
    (0.95, 0.5, 0.15), (0.1, 0.55, 0.6),
)  # fmt: skip
TROUSERS: tuple[Colour, ...] = (
    (0.16, 0.2, 0.34),
    (0.22, 0.22, 0.22),
    (0.55, 0.47, 0.35),
    (0.35, 0.25, 0.2),
    (0.3, 0.38, 0.5),
)


@dataclass(frozen=True)
class Outfit:
    """What a person looks like.

    Attributes:
        skin: of face and arms.
        hair: on the head.
        shirt: on the torso and, to the elbows or the wrists, on the arms.
        trousers: on the legs.
        shoes: on the feet.
        long_sleeves: whether the shirt covers the forearms.
    """

    skin: Material
    hair: Material
    shirt: Material
    trousers: Material
    shoes: Material
    long_sleeves: bool

    @classmethod
    def random(cls, rng: np.random.Generator) -> Outfit:
        """Some outfit."""
        skin, hair, shirt, trousers = (c[rng.integers(len(c))] for c in (SKINS, HAIRS, SHIRTS, TROUSERS))
        pattern, scale = (("plain", 1.0), ("plain", 1.0), ("stripes", 0.06), ("checks", 0.09))[rng.integers(4)]
        return cls(
            Material(skin),
            Material(hair),
            Material(shirt, shade(shirt, 0.72), pattern, scale),
            Material(trousers),
            Material((0.13, 0.12, 0.12) if rng.random() < 0.6 else (0.85, 0.85, 0.85)),
            bool(rng.random() < 0.5),
        )


def figure(joints: Float[np.ndarray, "19 3"], outfit: Outfit, scale: float) -> Surfaces:
    """The surfaces of a person whose joints (`GTA_IM_19`, metres, world frame) are these.

    Args:
        joints: of one frame.
        outfit: the person's looks.
        scale: factor on the thickness of the body.
    """
    body = _Body(joints, outfit, scale)
    body.torso()
    body.head()
    for side in ("right", "left"):
        body.arm(side)
        body.leg(side)
    return body.surfaces.gathered()


class _Body:
    def __init__(self, joints: np.ndarray, outfit: Outfit, scale: float) -> None:
        self.at = dict(zip(GTA_IM_19.joints, joints))
        self.outfit, self.scale = outfit, scale
        self.surfaces = SurfaceList()

    def _add(self, triangles: np.ndarray, material: Material) -> None:
        root = self.at["root"]
        self.surfaces.add(triangles, PERSON, material, (float(root[0]), float(root[1]), float(root[2])))

    def _limb(self, start: np.ndarray, end: np.ndarray, radii: tuple[float, float], material: Material) -> None:
        self._add(tapered(start, end, radii[0] * self.scale, radii[1] * self.scale), material)

    def torso(self) -> None:
        """A loft from the hips to the neck."""
        at, s = self.at, self.scale
        hips = unit(at["left_hip"] - at["right_hip"])
        shoulders = unit(at["left_shoulder"] - at["right_shoulder"])
        up = unit(at["neck"] - at["root"])
        middle = (at["left_hip"] + at["right_hip"]) / 2
        rows = [
            (middle - 0.07 * s * up, 0.06, 0.06, 0.0),
            (middle - 0.02 * s * up, 0.165, 0.11, 0.0),
            (at["root"] + 0.03 * s * up, 0.158, 0.11, 0.1),
            (at["spine2"], 0.138, 0.1, 0.4),
            (at["spine1"], 0.15, 0.105, 0.7),
            (at["spine0"], 0.17, 0.115, 0.9),
            (0.4 * at["spine0"] + 0.6 * at["neck"], 0.195, 0.115, 1.0),
            (at["neck"] - 0.045 * s * up, 0.185, 0.085, 1.0),
            (at["neck"] - 0.01 * s * up, 0.11, 0.065, 1.0),
            (at["neck"] + 0.02 * s * up, 0.055, 0.055, 1.0),
        ]
        rings = []
        for centre, wide, deep, share in rows:
            aside = unit((1 - share) * hips + share * shoulders)
            ahead = unit(np.cross(aside, up))
            rings.append(centre + s * (RING[:, :1] * wide * aside + RING[:, 1:] * deep * ahead))
        belt = 3
        self._add(loft(np.stack(rings[:belt])), self.outfit.trousers)
        self._add(loft(np.stack(rings[belt - 1 :])), self.outfit.shirt)

    def head(self) -> None:
        """Neck, face and hair."""
        at, s = self.at, self.scale
        up = unit(at["head"] - at["neck"])
        aside = unit(at["left_shoulder"] - at["right_shoulder"])
        ahead = unit(np.cross(aside, up))
        middle = at["head"] + 0.06 * s * up + 0.01 * s * ahead
        self._limb(at["neck"] - 0.02 * up, at["head"] + 0.02 * up, (0.055, 0.05), self.outfit.skin)
        axes = np.stack([ahead, aside, up])
        self._add(ellipsoid(middle, axes, s * np.array([0.095, 0.075, 0.118])), self.outfit.skin)
        crown = middle + s * (0.028 * up - 0.022 * ahead)
        self._add(ellipsoid(crown, axes, s * np.array([0.098, 0.083, 0.11])), self.outfit.hair)
        self._limb(
            middle + 0.08 * s * ahead, middle + s * (0.105 * ahead - 0.02 * up), (0.018, 0.014), self.outfit.skin
        )

    def arm(self, side: str) -> None:
        """Upper arm, forearm and hand."""
        shoulder, elbow, wrist = (self.at[f"{side}_{name}"] for name in ("shoulder", "elbow", "wrist"))
        sleeve = self.outfit.shirt if self.outfit.long_sleeves else self.outfit.skin
        self._limb(shoulder, elbow, (0.056, 0.044), self.outfit.shirt)
        self._limb(elbow, wrist, (0.043, 0.032), sleeve)
        along = unit(wrist - elbow) * self.scale
        self._limb(wrist + 0.02 * along, wrist + 0.12 * along, (0.036, 0.026), self.outfit.skin)

    def leg(self, side: str) -> None:
        """Thigh, shin and shoe."""
        hip, knee, ankle = (self.at[f"{side}_{name}"] for name in ("hip", "knee", "ankle"))
        self._limb(hip, knee, (0.092, 0.062), self.outfit.trousers)
        self._limb(knee, ankle, (0.058, 0.042), self.outfit.trousers)
        s = self.scale
        shin = unit(ankle - knee)
        ahead = np.cross(unit(self.at["left_hip"] - self.at["right_hip"]), [0, 0, 1.0])
        # The foot keeps at a right angle to a shin that leans far, as in a swing, and flat under one that does not.
        lifted = unit(ahead - (ahead @ shin) * shin)
        bend = np.clip((np.arccos(np.clip(-shin[2], -1, 1)) - 0.5) / 0.5, 0, 1) if shin @ ahead < 0 else 0.0
        ahead = unit((1 - bend) * ahead + bend * lifted)
        down = unit(np.array([0, 0, -1.0]) + (ahead[2]) * ahead)
        heel = ankle + s * (0.045 * down - 0.035 * ahead)
        self._limb(heel, ankle + s * (0.05 * down + 0.15 * ahead), (0.04, 0.035), self.outfit.shoes)
