"""The skeleton that a config names, built in or told by a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from sag.errors import SagError
from sag.skeleton.known import SKELETONS
from sag.skeleton.tree import Skeleton


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
        told = yaml.safe_load(path.read_text())
        parts, limbs = ({str(k): _names(v) for k, v in told[level].items()} for level in ("parts", "limbs"))
        bones = tuple((parent, child) for parent, child in map(_names, told["bones"]))
        made = str(told["name"]), _names(told["joints"]), bones, str(told["root"]), parts, limbs
    except OSError as error:
        raise SagError(f"{path} cannot be read ({error.strerror}); it is to tell a skeleton") from error
    except (yaml.YAMLError, UnicodeDecodeError, KeyError, TypeError, ValueError, AttributeError) as error:
        said = " ".join(str(error).split())
        raise SagError(f"{path} tells no name, joints, bones, root, parts and limbs of a skeleton ({said})") from error
    if made[0] in SKELETONS:
        raise SagError(f"{path} takes the name {made[0]} of a skeleton that is built in; give it another")
    try:
        return Skeleton(*made, path)
    except SagError as error:
        raise SagError(f"{path}: {error}") from error


def _names(told: Any) -> tuple[str, ...]:
    if not isinstance(told, list) or not all(isinstance(name, str) for name in told):
        raise ValueError(f"expected a list of names, found {told!r}")
    return tuple(told)
