"""The arguments of `sag sweep`."""

from __future__ import annotations

import argparse
from pathlib import Path

from sag.errors import SagError

DESCRIPTION = """\
Trains and tests every row of a sweep file (W&B's format; grid, random or bayes), each in a process of its own,
after the encoders of Motion FID and the ground truth; last, where components vary, a row that is blind to
the scene. Rows that have finished are not run again, so the same command continues after Ctrl-C, a crash or
a changed config, and rows that a sweep in a folder beside this one has finished are copied from there;
a row that fails does not stop the others.
Every row has a folder with its log.txt, status.json and metrics.json; `sag report` makes tables of them."""

FLAGS = {
    "partition": ("NAME", "partition, such as gpu"),
    "time": ("TIME", "time of a row, such as 8:00:00; one that needs longer is queued again and goes on"),
    "cpus-per-task": ("N", "cores of a row"),
    "mem": ("SIZE", "memory of a row, such as 16G"),
    "account": ("NAME", "account that pays"),
    "qos": ("NAME", "quality of service"),
    "constraint": ("FEATURE", "what a node must have"),
}
"""Options of sbatch that have one of their own here, with what they take and mean."""

SHORT = {"cpus-per-task": "cpus"}


def parser() -> argparse.ArgumentParser:
    """The arguments of `sag sweep`."""
    made = argparse.ArgumentParser(
        prog="sag sweep", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = made.add_argument
    add("file", type=Path, metavar="FILE", help="sweep file, such as sweeps/ablation.yaml")
    add("--out", type=Path, metavar="DIR", help="folder of the rows (default: runs/<name of the sweep>)")
    add("--jobs", type=int, metavar="N", help="rows at a time (default: one for each GPU, or 2; in SLURM all)")
    add("--gpus", type=int, metavar="N", help="GPUs of each row (default: 1 where there are any; in SLURM none)")
    add("--seeds", type=int, metavar="N", help="run every row with the seeds 0 to N-1")
    add("--search-seed", type=int, default=0, metavar="N", help="seed of what random and bayes draw (default: 0)")
    add("--config", action="append", default=[], metavar="YAML", help=(
        "config laid over those of the file, such as configs/data/gta_im.yaml; may be given again"))  # fmt: skip
    add("--set", action="append", default=[], metavar="KEY=VALUE", help=(
        "key set for every row, such as data.init_args.root=PATH; may be given again"))  # fmt: skip
    add("--pretrained", type=Path, metavar="DIR", help=(
        "folder of the same sweep on other data: every row starts in the last checkpoint of its namesake there"
    ))  # fmt: skip
    add("--dry-run", action="store_true", help="print the commands and run nothing")
    add("--status", action="store_true", help="show how far the rows are, wherever they run, and run nothing")
    _add_slurm(made)
    return made


def _add_slurm(made: argparse.ArgumentParser) -> None:
    slurm = made.add_argument_group("on a SLURM cluster", "the rows as one job array; needs the extra 'slurm'")
    slurm.add_argument("--slurm", action="store_true", help="hand the rows to SLURM, then show how far they are")
    slurm.add_argument("--detach", action="store_true", help="leave after handing over; --status shows the rest")
    for flag, (takes, about) in FLAGS.items():
        slurm.add_argument(f"--{SHORT.get(flag, flag)}", dest=flag, metavar=takes, help=about)
    slurm.add_argument(
        "--sbatch",
        action="append",
        default=[],
        metavar="OPTION=VALUE",
        help="any other option of sbatch, such as exclude=node7; may be given again",
    )


def sbatch_flags(asked: argparse.Namespace) -> dict[str, str]:
    """What a call asks of SLURM, as long options of sbatch with their values."""
    flags = {flag: str(value) for flag in FLAGS if (value := getattr(asked, flag)) is not None}
    if asked.gpus:
        flags["gpus-per-node"] = str(asked.gpus)
    return {**flags, **dict(option.removeprefix("--").split("=", 1) for option in asked.sbatch)}


def check(asked: argparse.Namespace) -> None:
    """Refuses what means nothing.

    Raises:
        SagError: a number is too small, `=` is missing, or an option is for SLURM and `--slurm` is not there.
    """
    if asked.jobs is not None and asked.jobs < 1:
        raise SagError(f"--jobs {asked.jobs}: at least one row runs at a time")
    if asked.gpus is not None and asked.gpus < 0:
        raise SagError(f"--gpus {asked.gpus}: a row has 0 GPUs or more")
    if asked.seeds is not None and asked.seeds < 1:
        raise SagError(f"--seeds {asked.seeds}: every row needs at least one seed")
    for name, example in (("set", "data.init_args.root=PATH"), ("sbatch", "exclude=node7")):
        for setting in getattr(asked, name):
            if "=" not in setting:
                raise SagError(f"--{name} {setting}: write it as key=value, such as {example}")
    _check_slurm(asked)


def _check_slurm(asked: argparse.Namespace) -> None:
    given = [f"--{SHORT.get(flag, flag)}" for flag in FLAGS if getattr(asked, flag) is not None]
    given += ["--sbatch"] * bool(asked.sbatch) + ["--detach"] * asked.detach
    if given and not asked.slurm:
        raise SagError(f"{given[0]} is for a SLURM cluster: add --slurm, or leave it out")
