"""The skeleton that a config names, built in or told by a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from sag.errors import SagError
from sag.skeleton.known import SKELETONS
from sag.skeleton.tree import Skeleton

SIZE_LIMIT = 1 << 16
"""Largest file that is read, bytes."""

MOST_NAMES = 500
"""Most names in a list of one."""

LONGEST_NAME = 80
"""Most characters of a name."""


class _PlainLoader(yaml.SafeLoader):
    """Reads no aliases: with them a few hundred bytes can tell a list of millions."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("it has an alias; write the list out")
        return super().compose_node(parent, index)


def skeleton_named(name: str) -> Skeleton:
    """The skeleton of that name, or the one that a file tells.

    Args:
        name: one of `SKELETONS`, or the path of a `.yaml` file, see `read_skeleton`.

    Raises:
        SagError: no skeleton has this name, or the file tells none.
    """
    if Path(name).suffix in (".yaml", ".yml"):
        return read_skeleton(Path(name))
    if name not in SKELETONS:
        raise SagError(f"no skeleton is called {name!r}; known are {', '.join(SKELETONS)}, or give a .yaml file of one")
    return SKELETONS[name]


def read_skeleton(path: Path) -> Skeleton:
    """The skeleton that a YAML file tells: `name`, `joints`, `bones`, `root`, `parts` and `limbs`.

    Raises:
        SagError: the file is missing, lacks an entry, or tells no tree whose groups hold every joint once.
    """
    try:
        told = yaml.load(_text(path), _PlainLoader)
        parts, limbs = _groups(told, "parts"), _groups(told, "limbs")
        bones = tuple((parent, child) for parent, child in (_names(bone, "a bone") for bone in told["bones"]))
        name, root = (_names([str(told[entry])], entry)[0] for entry in ("name", "root"))
        made = name, _names(told["joints"], "joints"), bones, root, parts, limbs
    except OSError as error:
        raise SagError(f"{path} cannot be read ({error.strerror}); it is to tell a skeleton") from error
    except (yaml.YAMLError, KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        said = " ".join(str(error).split())[:200]
        raise SagError(f"{path} tells no name, joints, bones, root, parts and limbs of a skeleton ({said})") from error
    if made[0] in SKELETONS:
        raise SagError(f"{path} takes the name {made[0]} of a skeleton that is built in; give it another")
    try:
        return Skeleton(*made, path)
    except SagError as error:
        raise SagError(f"{path}: {error}") from error


def _text(path: Path) -> str:
    if path.exists() and not path.is_file():
        raise ValueError("it is no regular file")
    with path.open("rb") as file:
        content = file.read(SIZE_LIMIT + 1)
    if len(content) > SIZE_LIMIT:
        raise ValueError(f"it is larger than {SIZE_LIMIT:,} bytes")
    return content.decode()


def _groups(told: Any, entry: str) -> dict[str, tuple[str, ...]]:
    groups = {str(name): _names(members, f"a group of {entry}") for name, members in told[entry].items()}
    _names(list(groups), entry)
    return groups


def _names(told: Any, entry: str) -> tuple[str, ...]:
    """The names that an entry lists; the error tells the entry, not what stands there, which may be endless."""
    if not isinstance(told, list) or not all(isinstance(name, str) for name in told):
        raise ValueError(f"{entry}: expected a list of names")
    if len(told) > MOST_NAMES or any(len(name) > LONGEST_NAME for name in told):
        raise ValueError(f"{entry}: more than {MOST_NAMES} names, or one of more than {LONGEST_NAME} characters")
    return tuple(told)
