"""The skeletons that are built in: those of GTA-IM and PROX."""

from __future__ import annotations

from sag.skeleton.levels import Groups
from sag.skeleton.tree import Skeleton


def _sides(*names: str) -> tuple[str, ...]:
    return tuple(f"{side}_{name}" for side in ("right", "left") for name in names)


def _limb_bones(neck: str, root: str) -> tuple[tuple[str, str], ...]:
    arms = [(neck, "shoulder"), ("shoulder", "elbow"), ("elbow", "wrist")]
    legs = [(root, "hip"), ("hip", "knee"), ("knee", "ankle")]
    middle = (neck, root)
    return tuple(
        (a if a in middle else f"{side}_{a}", f"{side}_{b}")
        for chain in (arms, legs)
        for side in ("right", "left")
        for a, b in chain
    )


_LIMB_PARTS: Groups = {
    f"{side}_{end}": tuple(f"{side}_{n}" for n in names)
    for side in ("right", "left")
    for end, names in {
        "elbow": ("shoulder", "elbow"),
        "wrist": ("wrist",),
        "knee": ("hip", "knee"),
        "ankle": ("ankle",),
    }.items()
}

_LIMBS: Groups = {
    "torso": ("head", "neck", "root"),
    **{f"{s}_arm": (f"{s}_elbow", f"{s}_wrist") for s in ("right", "left")},
    **{f"{s}_leg": (f"{s}_knee", f"{s}_ankle") for s in ("right", "left")},
}

_SPINE = ("spine0", "spine1", "spine2", "spine3", "root")

GTA_IM_19 = Skeleton(
    name="gta_im_19",
    joints=("head", "neck", *_sides("shoulder", "elbow", "wrist"), *_SPINE, *_sides("hip", "knee", "ankle")),
    bones=(
        *tuple(zip(_SPINE[:0:-1], _SPINE[-2::-1])),
        ("spine0", "neck"),
        ("neck", "head"),
        *_limb_bones("neck", "root"),
    ),
    root="root",
    parts={
        "head": ("head",),
        "neck": ("neck", "spine0", "spine1"),
        "root": ("spine2", "spine3", "root"),
        **_LIMB_PARTS,
    },
    limbs=_LIMBS,
)
"""GTA-IM's 21 joints less the clavicles; the root is the lowest of its spine joints (spine4 there)."""

PROX_16 = Skeleton(
    name="prox_16",
    joints=(
        "head", "neck", *_sides("shoulder", "elbow", "wrist"), "chest", "root", *_sides("hip", "knee", "ankle"),
    ),
    bones=(("root", "chest"), ("chest", "neck"), ("neck", "head"), *_limb_bones("neck", "root")),
    root="root",
    parts={"head": ("head",), "neck": ("neck", "chest"), "root": ("root",), **_LIMB_PARTS},
    limbs=_LIMBS,
)  # fmt: skip
"""16 joints of SMPL-X that GTA-IM has too."""

SKELETONS: dict[str, Skeleton] = {s.name: s for s in (GTA_IM_19, PROX_16)}
"""Every skeleton a config can name."""
