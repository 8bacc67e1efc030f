"""`sag data prepare PATH`: converts a data set into the cache that training reads."""

from __future__ import annotations

import argparse
import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sag.data.known import recognised
from sag.data.options import PREFIX, module_from
from sag.data.recordings.scratch import SUFFIX

PAPER_ROWS = 288
"""Rows of the paper's pictures, for which its preset is meant."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag data prepare`."""
    made = argparse.ArgumentParser(
        "sag data prepare",
        allow_abbrev=False,
        description="Converts GTA-IM or PROX into the cache that training reads, going on where it was interrupted.",
        epilog="Further options are those of training, such as --image_size=[72,128] or --skip_broken true.",
    )
    made.add_argument("path", type=Path, metavar="PATH", help="root of GTA-IM or PROX")
    made.add_argument("--out", type=Path, metavar="DIR", help="folder of the caches (default: data)")
    made.add_argument("--config", type=Path, action="append", default=[], help="file with data.init_args; may repeat")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Builds the cache that training with the same options would build, and says how to train on it.

    Raises:
        SagError: there is no data set, an option is wrong, or the disk has too little room.
    """
    asked, options = parser().parse_known_args(arguments)
    known, root = recognised(asked.path)
    if asked.out is not None:
        options = [*options, f"--cache_dir={asked.out}"]
    module, given = module_from(known, root, options, asked.config)
    folder = module.cache.folder
    size = sum(path.stat().st_size for path in folder.iterdir())
    print(f"{folder}: {size / 1e6:,.0f} MB")
    for left in sorted(module.cache_dir.glob(f"{known.name}-*{SUFFIX}")):
        print(f"{left} is an interrupted conversion with other options or files; delete it if it is not wanted")
    options_there = {**given, "root": root.resolve(), "image_size": list(module.image_size)}
    print("to train on it:\n  " + training_command(known.name, options_there, asked.config))
    return 0


def training_command(name: str, options: dict[str, Any], configs: Sequence[Path]) -> str:
    """The command that trains on exactly this cache, over several lines.

    Args:
        name: of the data set's config.
        options: of the data module, those that other configs set among them.
        configs: that were given, instead of a preset for the size of the pictures.
    """
    preset = "paper" if options["image_size"][0] >= PAPER_ROWS else "quick"
    chosen = [str(path) for path in configs] or [f"configs/presets/{preset}.yaml"]
    usual = ["configs/base.yaml", *chosen, f"configs/data/{name}.yaml"]
    said = [f"--config {shlex.quote(str(path))}" for path in dict.fromkeys(usual)]
    said += [shlex.quote(f"--{PREFIX}{option}={_written(value)}") for option, value in sorted(options.items())]
    return " \\\n    ".join(["sag run", *said])


def _written(value: Any) -> str:
    """A value as an option of the command line."""
    return str(value) if isinstance(value, str | Path) else json.dumps(value, default=str)
