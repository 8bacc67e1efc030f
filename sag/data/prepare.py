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
from sag.text import plain

INTERRUPTED = 130
"""Exit status of a command that Ctrl-C ends, as shells have it."""

BASE, ENCODERS = "configs/base.yaml", "configs/methods/erd.yaml"
"""Configs under every training, and over that of Motion FID's encoders."""

QUICK_SIZE = "--image_size=[72,128]"
"""Pictures of `configs/base.yaml` and of the quick preset, which are made where nothing else is asked for."""

PAPER_ROWS = 288
"""Rows of the paper's pictures, for which its preset is meant."""


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag data prepare`."""
    made = argparse.ArgumentParser(
        "sag data prepare",
        allow_abbrev=False,
        description="Converts GTA-IM, PROX or your own data into the cache that training reads, going on where it was "
        "interrupted.",
        epilog="Further options are those of training, such as --stride 1 or --skip_broken true; for the paper's "
        "pictures --config configs/presets/paper.yaml.",
    )
    made.add_argument("path", type=Path, metavar="PATH", help="root of the data set")
    made.add_argument("--out", type=Path, metavar="DIR", help="folder of the caches (default: data)")
    made.add_argument("--config", type=Path, action="append", default=[], help="file with data.init_args; may repeat")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Builds the cache that training with the same options would build, and says how to train on it.

    Returns:
        `INTERRUPTED` where it was, else 0.

    Raises:
        SagError: there is no data set, an option is wrong, or the disk has too little room.
    """
    asked, options = parser().parse_known_args(arguments)
    known, root = recognised(asked.path)
    if asked.out is not None:
        options = [*options, f"--cache_dir={asked.out}"]
    if not asked.config and not any("image_size" in option for option in options):
        options = [*options, QUICK_SIZE]
    module, given = module_from(known, root, options, asked.config)
    try:
        folder = module.cache.folder
    except KeyboardInterrupt:
        print(f"\ninterrupted; {_what_is_left(module.cache_dir, known.name)}")
        return INTERRUPTED
    size = sum(path.stat().st_size for path in folder.iterdir())
    print(f"{plain(str(folder))}: {size / 1e6:,.0f} MB")
    for left in _unfinished(module.cache_dir, known.name):
        print(f"{plain(str(left))} is an interrupted conversion with other options or files; delete it if not wanted")
    options_there = {**given, "root": root.resolve(), "cache_dir": module.cache_dir.resolve()}
    options_there["image_size"] = list(module.image_size)
    if module.skeleton.path is not None:
        options_there["skeleton"] = module.skeleton.path.resolve()
    print(f"to train Motion FID's encoders on it, once, then a method, where {BASE} lies:")
    print("  " + training_command("fit", known.name, options_there, asked.config, (ENCODERS,)))
    print("  " + training_command("run", known.name, options_there, asked.config))
    return 0


def _unfinished(cache_dir: Path, name: str) -> list[Path]:
    """Folders of conversions of a data set that were interrupted."""
    return sorted(cache_dir.glob(f"{name}-*{SUFFIX}"))


def _what_is_left(cache_dir: Path, name: str) -> str:
    """What an interrupted conversion can go on with."""
    left = _unfinished(cache_dir, name)
    if not left:
        return "no window was finished, so the same command begins anew"
    return f"the same command goes on with what is finished, in {', '.join(map(str, left))}"


def training_command(
    what: str, name: str, options: dict[str, Any], configs: Sequence[Path], last: Sequence[str] = ()
) -> str:
    """A command that trains on exactly this cache, over several lines.

    Args:
        what: the subcommand.
        name: of the data set's config.
        options: of the data module, those that other configs set among them.
        configs: that were given, instead of a preset for the size of the pictures.
        last: configs laid over all others.
    """
    preset = "paper" if options["image_size"][0] >= PAPER_ROWS else "quick"
    chosen = [str(path) for path in configs] or [f"configs/presets/{preset}.yaml"]
    usual = [BASE, *chosen, f"configs/data/{name}.yaml", *last]
    said = [f"--config {shlex.quote(str(path))}" for path in dict.fromkeys(usual)]
    said += [shlex.quote(f"--{PREFIX}{option}={_written(value)}") for option, value in sorted(options.items())]
    return " \\\n    ".join([f"sag {what}", *said])


def _written(value: Any) -> str:
    """A value as an option of the command line."""
    return str(value) if isinstance(value, str | Path) else json.dumps(value, default=str)
