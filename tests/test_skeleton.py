import dataclasses

import pytest

from sag.errors import SagError
from sag.skeleton import GTA_IM_19, SKELETONS, skeleton_named

ARM, LEG = ("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle")

GTA_IM_21 = [
    "head",
    "neck",
    *(f"{side}_{joint}" for side in ("right", "left") for joint in ("clavicle", *ARM)),
    *("spine0", "spine1", "spine2", "spine3", "root"),
    *(f"{side}_{joint}" for side in ("right", "left") for joint in LEG),
]
"""The joints of GTA-IM's own arrays."""


def test_gta_im_without_clavicles_in_its_order() -> None:
    assert list(GTA_IM_19.joints) == [j for j in GTA_IM_21 if "clavicle" not in j]


@pytest.mark.parametrize("name", SKELETONS)
def test_levels_shrink_to_one_body(name: str) -> None:
    skeleton = skeleton_named(name)
    assert [len(level.nodes) for level in skeleton.levels] == [len(skeleton.joints), 11, 5, 1]
    for level in skeleton.levels:
        assert (level.members.sum(1) == 1).all()
        assert (level.adjacency == level.adjacency.T).all()
        assert level.distance.min() == 0


@pytest.mark.parametrize("name", SKELETONS)
def test_bones_are_a_tree_from_the_root(name: str) -> None:
    skeleton = skeleton_named(name)
    assert len(skeleton.bones) == len(skeleton.joints) - 1
    reached = {skeleton.root}
    for parent, child in skeleton.bones:
        assert parent in reached
        reached.add(child)
    assert reached == set(skeleton.joints)


@pytest.mark.parametrize("name", SKELETONS)
def test_mirror_is_its_own_inverse_and_keeps_bones(name: str) -> None:
    skeleton = skeleton_named(name)
    mirror = skeleton.mirror
    assert [mirror[m] for m in mirror] == list(range(len(mirror)))
    pairs = {frozenset(b) for b in skeleton.bone_index.tolist()}
    assert {frozenset(mirror[j] for j in pair) for pair in pairs} == pairs


def test_unknown_names_are_refused() -> None:
    with pytest.raises(SagError, match="gta_im_19"):
        skeleton_named("coco")


def test_a_joint_in_two_groups_is_refused() -> None:
    parts = {**GTA_IM_19.parts, "head": ("head", "neck")}
    with pytest.raises(SagError, match="once"):
        dataclasses.replace(GTA_IM_19, parts=parts)
