"""The data set that motions of a file are held against, as commands are told it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jsonargparse import ArgumentParser

from sag.data.base import MotionDataModule
from sag.data.known import DATA_SETS
from sag.errors import SagError
from sag.files import read_yaml
from sag.parsing import one_sentence_each

BESIDE = ("config.predict.yaml", "config.fit.yaml")
"""Configs that a run leaves beside a file of motions, the first that is there being the one that made it."""


def config_beside(file: Path) -> str | None:
    """The config beside a file of motions that tells its data set, if there is one."""
    return next((str(path) for name in BESIDE if (path := file.parent / name).is_file()), None)


def data_reference(name: str) -> dict[str, Any]:
    """The data set that a name or a YAML file stands for, as class and options.

    Args:
        name: one of `DATA_SETS`, or the path of a YAML file with a key `data`, such as a run's config.fit.yaml.

    Raises:
        SagError: it is neither.
    """
    if name in DATA_SETS:
        return {"class_path": DATA_SETS[name]}
    path = Path(name)
    if not path.is_file():
        raise SagError(f"--reference {name} is neither a file nor one of {', '.join(DATA_SETS)}")
    content = read_yaml(path)
    data = content.get("data") if isinstance(content, dict) else None
    if not isinstance(data, dict) or not isinstance(data.get("init_args") or {}, dict):
        raise SagError(f"--reference {name} is no YAML file with `data` and its init_args, such as a config.fit.yaml")
    return data


def data_of(name: str, cache_dir: Path | None = None) -> MotionDataModule:
    """The data set that a name or a YAML file stands for, see `data_reference`.

    Args:
        name: of the data set, or the path of the file.
        cache_dir: where the window caches are, if not where the file says.

    Raises:
        SagError: it is neither, or its options are wrong.
    """
    content = data_reference(name)
    if cache_dir is not None:
        content = {**content, "init_args": {**(content.get("init_args") or {}), "cache_dir": str(cache_dir)}}
    return data_from(content, name)


def data_from(content: dict[str, Any], name: str) -> MotionDataModule:
    """The data set of a class and its options.

    Args:
        content: `class_path` and `init_args`.
        name: what the sentence calls it.

    Raises:
        SagError: its options are wrong.
    """
    parser = ArgumentParser(exit_on_error=False)
    parser.add_subclass_arguments(MotionDataModule, "data", required=True)
    with one_sentence_each(about=f"--reference {name}: "):
        return parser.instantiate_classes(parser.parse_object({"data": content})).data
