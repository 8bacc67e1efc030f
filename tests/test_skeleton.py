import dataclasses
import re
import time
from pathlib import Path

import pytest
import yaml

from sag.errors import SagError
from sag.skeleton import GTA_IM_19, PROX_16, SKELETONS, skeleton_named

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


def told(tmp_path: Path, **changes: object) -> Path:
    """A file that tells `prox_16` under another name, with changes; nothing takes an entry away."""
    content = {**PROX_16.description, "name": "mine", **changes}
    path = tmp_path / "skeleton.yaml"
    kept = {key: value for key, value in content.items() if value is not None}
    path.write_text(yaml.safe_dump(kept, sort_keys=False))
    return path


def test_a_file_tells_a_skeleton(tmp_path: Path) -> None:
    path = told(tmp_path)
    read = skeleton_named(str(path))
    assert read.description == {**PROX_16.description, "name": "mine"}
    assert read.reference == str(path)
    assert [level.nodes for level in read.levels] == [level.nodes for level in PROX_16.levels]
    assert (read.levels[1].adjacency == PROX_16.levels[1].adjacency).all()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"joints": None}, "tells no name, joints"),
        ({"joints": "head"}, "list of names"),
        ({"bones": [["root", "chest", "neck"]]}, "tells no name, joints"),
        ({"bones": [["chest", "neck"], ["root", "chest"]]}, "must come after"),
        ({"bones": [["root", "chest"], ["root", "chest"]]}, "no other may lead to chest"),
        ({"bones": [["root", "chest"]]}, "to all joints, unlike"),
        ({"joints": [*PROX_16.joints, "head"]}, "a joint twice"),
        ({"root": "tail"}, "must come after"),
        ({"parts": {"all": ["head"]}}, "once"),
        ({"name": "prox_16"}, "built in"),
    ],
)
def test_a_file_that_tells_none_is_refused(tmp_path: Path, changes: dict[str, object], said: str) -> None:
    path = told(tmp_path, **changes)
    with pytest.raises(SagError, match=f"^{re.escape(str(path))}.*{said}"):
        skeleton_named(str(path))


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"joints: [", b"", b"- 1"])
def test_a_file_that_is_no_yaml_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "skeleton.yaml"
    path.write_bytes(content)
    with pytest.raises(SagError, match="tells no name"):
        skeleton_named(str(path))
    with pytest.raises(SagError, match="cannot be read"):
        skeleton_named(str(tmp_path / "missing.yaml"))


def laughs(levels: int = 7) -> str:
    """Aliases by which a few hundred bytes tell ten million names."""
    lines = ["a0: &a0 [x,x,x,x,x,x,x,x,x,x]"]
    lines += [f"a{n}: &a{n} [{','.join(10 * [f'*a{n - 1}'])}]" for n in range(1, levels)]
    return "\n".join([*lines, f"joints: *a{levels - 1}", "name: z", "parts: {}", "limbs: {}", "bones: []", "root: r"])


def merges(levels: int = 9) -> str:
    """The same with dictionaries that are merged."""
    lines = ["a0: &a0 {x: [y]}"]
    lines += [f"a{n}: &a{n} {{<<: [{','.join(10 * [f'*a{n - 1}'])}]}}" for n in range(1, levels)]
    return "\n".join(lines)


HOSTILE = {
    "aliases": laughs(),
    "merges": merges(),
    "deep": "joints: " + 3000 * "[" + 3000 * "]",
    "large": "joints: [" + 40_000 * "a," + "]",
    "long_number": "name: " + 60_000 * "9" + "\nparts: {}\nlimbs: {}\nbones: []",
    "long_key": "? " + str([20_000 * "x"]) + "\n: 1",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_soon_in_a_short_sentence(tmp_path: Path, name: str) -> None:
    path = tmp_path / "skeleton.yaml"
    path.write_text(HOSTILE[name])
    start = time.perf_counter()
    with pytest.raises(SagError, match="tells no name, joints") as error:
        skeleton_named(str(path))
    assert len(str(error.value)) < len(str(path)) + 300 and "\n" not in str(error.value)
    assert time.perf_counter() - start < 10


@pytest.mark.parametrize(
    ("changes", "entry"),
    [
        ({"joints": ["head", ["y" * 500]]}, "joints"),
        ({"joints": 5000 * ["a"]}, "joints"),
        ({"joints": ["y" * 81]}, "joints"),
        ({"bones": [["root", "y" * 81]]}, "a bone"),
        ({"parts": {"head": [[]]}}, "a group of parts"),
        ({"limbs": {"y" * 81: []}}, "limbs"),
        ({"root": "y" * 81}, "root"),
        ({"name": "y" * 5000}, "name"),
    ],
)
def test_the_entry_is_named_and_not_what_stands_there(tmp_path: Path, changes: dict[str, object], entry: str) -> None:
    with pytest.raises(SagError, match=rf"\({entry}: ") as error:
        skeleton_named(str(told(tmp_path, **changes)))
    assert "yyy" not in str(error.value)


@pytest.mark.parametrize("entry", ["joints", "bones", "parts"])
def test_a_tree_of_hundreds_is_refused_in_a_short_sentence(tmp_path: Path, entry: str) -> None:
    many = [f"joint_{number}" for number in range(400)]
    changed = {"joints": [*PROX_16.joints, *many], "bones": [["root", name] for name in many], "parts": {"all": many}}
    path = told(tmp_path, **{entry: changed[entry]})
    with pytest.raises(SagError) as error:
        skeleton_named(str(path))
    assert len(str(error.value)) < len(str(path)) + 500


def test_a_folder_is_no_skeleton(tmp_path: Path) -> None:
    (tmp_path / "skeleton.yaml").mkdir()
    with pytest.raises(SagError, match="no regular file"):
        skeleton_named(str(tmp_path / "skeleton.yaml"))
