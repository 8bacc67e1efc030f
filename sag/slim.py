"""`sag slim RUN --out DIR`: a trained run as small as it can be handed on, to sample and to test."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from omegaconf import OmegaConf

from sag.checkpoints import FOLDER, LAST, WholeCheckpoints
from sag.errors import SagError
from sag.files import read_yaml, write_whole
from sag.methods.pretrained import AVERAGED, SAMPLER
from sag.runs import CONFIG

DESCRIPTION = """\
Writes a run's config and a checkpoint without what only training needs: no optimisers, and the averaged weights in the
place of the raw ones, so that it samples what the run samples; depth is decoded from the averaged encoder then. About a
quarter of the size. It can be sampled, tested and started from (--pretrained), not resumed."""

KEPT = ("skeleton", "epoch", "global_step", "pytorch-lightning_version")


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag slim`."""
    made = argparse.ArgumentParser(
        prog="sag slim", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    made.add_argument("run", type=Path, metavar="RUN", help="folder of a trained run, such as runs/ablation/mdpc")
    made.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the small run")
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the small run and returns the exit status 0.

    Raises:
        SagError: there is no run, a file is damaged, or a checkpoint is in the way.
    """
    asked = parser().parse_args(arguments)
    folder = asked.run
    path = asked.out / FOLDER / LAST
    if path.exists():
        raise SagError(f"{path} is there already; name another --out, or remove it")
    if not (folder / CONFIG).is_file():
        raise SagError(f"{folder} holds no run: it has no {CONFIG}")
    config = OmegaConf.to_yaml(OmegaConf.create(without_average(read_yaml(folder / CONFIG), asked.out)))
    checkpoint = WholeCheckpoints().load_checkpoint(folder / FOLDER / LAST)
    path.parent.mkdir(parents=True, exist_ok=True)
    WholeCheckpoints().save_checkpoint(slimmed(checkpoint), path)
    write_whole(asked.out / CONFIG, lambda file: file.write(config.encode()))
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB, {(folder / FOLDER / LAST).stat().st_size / 1e6:.1f} MB before")
    return 0


def slimmed(checkpoint: Mapping[str, Any]) -> dict[str, Any]:
    """The checkpoint without the state of training, averaged weights in the place of raw ones."""
    state = dict(checkpoint["state_dict"])
    averages = {name: value for name, value in state.items() if name.startswith(AVERAGED)}
    weights = {name: value for name, value in state.items() if not name.startswith("averaged.")}
    weights |= {SAMPLER + name.removeprefix(AVERAGED): value for name, value in averages.items()}
    kept = {name: checkpoint[name] for name in KEPT if name in checkpoint}
    return kept | {"state_dict": weights, "callbacks": {}, "optimizer_states": [], "lr_schedulers": []}


def without_average(config: dict[str, Any], out: Path) -> dict[str, Any]:
    """The config of a run that keeps no average, goes on from nothing and writes to a folder of its own."""
    config.pop("ckpt_path", None)
    options = config["model"].setdefault("init_args", {})
    if "average" in options:
        options["average"] = 0.0
    place = f"runs/{out.resolve().name}"
    trainer = config.setdefault("trainer", {})
    trainer["default_root_dir"] = place
    logger = trainer.get("logger")
    if isinstance(logger, dict) and "save_dir" in logger.get("init_args", {}):
        logger["init_args"]["save_dir"] = place
    return config
