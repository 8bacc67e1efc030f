"""A data module from the options that training takes, with or without `--data.init_args.` before them."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jsonargparse import ArgumentError, ArgumentParser

from sag.data.base import MotionDataModule
from sag.data.known import KnownDataSet
from sag.errors import SagError
from sag.files import read_yaml

PREFIX = "data.init_args."
"""What training writes before the options of a data set."""


def module_from(
    known: KnownDataSet, root: Path, options: Sequence[str], configs: Sequence[Path] = ()
) -> tuple[MotionDataModule, dict[str, Any]]:
    """The data module that training would make, and those of its options that were given.

    Args:
        known: the data set.
        root: its folder.
        options: such as `--stride 5` or `--data.init_args.stride=5`.
        configs: files whose `data.init_args` come first, later ones over earlier ones.

    Raises:
        SagError: an option is unknown or wrong.
    """
    kind: Any = known.module_class
    parser = ArgumentParser(exit_on_error=False, add_help=False, allow_abbrev=False)
    parser.add_class_arguments(kind, skip={"root"})
    try:
        told = _from_configs(configs, set(inspect.signature(kind).parameters) - {"root"})
        parser.set_defaults(told)
        parsed = parser.parse_args([option.replace(f"--{PREFIX}", "--", 1) for option in options])
        given = told | _named(parsed.as_dict(), options)
        return kind(root=root, **parser.instantiate_classes(parsed).as_dict()), given
    except ArgumentError as error:
        said = " ".join(str(error).split())
        raise SagError(f"{said}; the options of {known.title} are those of {known.module}") from error


def _named(parsed: dict[str, Any], options: Sequence[str]) -> dict[str, Any]:
    """The options that were written out, with their values."""
    found = {}
    for option in options:
        if option.startswith("--"):
            name = option.removeprefix("--").removeprefix(PREFIX).partition("=")[0]
            value: Any = parsed
            for part in name.split("."):
                value = value[part]
            found[name] = value
    return found


def _from_configs(configs: Sequence[Path], names: set[str]) -> dict[str, Any]:
    """What config files say of a data set, with dots between nested names; what it does not take is left out."""
    found: dict[str, Any] = {}
    for path in configs:
        told = read_yaml(path)
        for key in ("data", "init_args"):
            told = told.get(key, {}) if isinstance(told, dict) else None
        if not isinstance(told, dict):
            raise SagError(f"{path} is no config: its data.init_args must map options to values")
        for name, value in told.items():
            if name in names:
                nested = value if isinstance(value, dict) else {}
                found |= {f"{name}.{part}": inner for part, inner in nested.items()} or {name: value}
    return found
