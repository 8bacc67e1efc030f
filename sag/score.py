"""`sag score FILE.npz --reference DATA`: every figure of a test for motions that something else has made."""

from __future__ import annotations

import csv
import io
import json
import logging
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import lightning.pytorch as pl
from jsonargparse import ArgumentParser, Namespace

from sag.data.base import MotionDataModule
from sag.data.known import DATA_SETS
from sag.files import write_json, write_whole
from sag.methods import GroundTruth, Recorded
from sag.methods.base import Method
from sag.metrics import collision_details
from sag.metrics.collisions.clear_frames import RADII
from sag.parsing import one_sentence_each
from sag.references import data_reference
from sag.report import show_scores
from sag.scoring import Evaluation


def main(arguments: Sequence[str] | None = None) -> int:
    """Scores a file of motions beside the ground truth, prints both and writes them to a file."""
    options, data = _parsed(sys.argv[1:] if arguments is None else arguments)
    logging.getLogger("lightning.pytorch.utilities.rank_zero").setLevel(logging.WARNING)
    motions = Recorded(options.file, data.skeleton.reference, options.evaluation)
    truth = GroundTruth(data.skeleton.reference, motions.evaluation)
    truth.needs_encoders = False
    figures = _tested(motions, data)
    truth.windows = motions.windows
    content = {
        "file": str(options.file),
        "data": data.describe(),
        "protocol": motions.protocol(),
        "metrics": figures,
        "ground_truth": _tested(truth, data),
        "motion_fid_distances": motions.scores.distances(),
    }
    out = options.out or options.file.with_suffix(".scores.json")
    write_json(out, content)
    show_scores(str(options.file), content)
    if options.collisions:
        _write_collisions(options.collisions, motions, data)
        print(f"which bone touches what, and when, is in {options.collisions}")
    print(f"the figures are in {out}")
    return 0


def _tested(method: Method, data: MotionDataModule) -> dict[str, float]:
    trainer = pl.Trainer(accelerator="auto", devices=1, logger=False, enable_checkpointing=False)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*num_workers.*")
        trainer.test(method, datamodule=data, verbose=False)
    return {name.removeprefix("test/"): float(value) for name, value in trainer.callback_metrics.items()}


def _write_collisions(path: Path, motions: Recorded, data: MotionDataModule) -> None:
    """Every bone that touches the scene in a generated frame of the first motions, a line each; the widest radius."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(("window", "frame", "bone", "points", "depth_mm"))
    skeleton = data.skeleton
    for batch in data.test_dataloader():
        for place, window in enumerate(batch.index.tolist()):
            if window not in motions.rows:
                continue
            one = batch[place : place + 1]
            joints, shape = motions.sample(one).joints[0, 1:], motions.evaluation.collision_shape
            details = collision_details(joints, skeleton.bone_index, one.cloud, max(RADII), shape)
            for found in details.worst(skeleton.bones, count=details.points.numel()):
                lines.writerow((window, found.frame + 1, found.bone, found.points, f"{1000 * found.depth:.1f}"))
    write_whole(path, lambda file: file.write(text.getvalue().encode()))


def _parsed(arguments: Sequence[str]) -> tuple[Namespace, MotionDataModule]:
    parser = ArgumentParser(prog="sag score", description=__doc__, exit_on_error=False)
    parser.add_argument("file", type=Path, help="motions, a .npz as `sag predict` writes it (see sag.data.motion_file)")
    parser.add_argument(
        "--reference",
        required=True,
        help=f"the data set: {', '.join(DATA_SETS)}, or a YAML file with a key `data`, such as a run's config.fit.yaml",
    )
    parser.add_argument("--out", type=Path | None, default=None, help="figures as JSON; FILE.scores.json by default")
    parser.add_argument("--collisions", type=Path | None, default=None, help="CSV of which bone touches what, and when")
    parser.add_subclass_arguments(MotionDataModule, "data", required=True)
    parser.add_class_arguments(Evaluation, "evaluation")
    with one_sentence_each():
        return _instantiated(parser, arguments)


def _instantiated(parser: ArgumentParser, arguments: Sequence[str]) -> tuple[Namespace, MotionDataModule]:
    """Options and data; the data's own options may follow, such as --data.init_args.root."""
    reference = _value_of("--reference", arguments)
    known = [] if reference is None else [f"--data={json.dumps(data_reference(reference))}"]
    made = parser.instantiate_classes(parser.parse_args([*known, *arguments]))
    return made, made.data


def _value_of(option: str, arguments: Sequence[str]) -> str | None:
    """What follows an option, as `--option value` or `--option=value`."""
    for place, argument in enumerate(arguments):
        if argument == option and place + 1 < len(arguments):
            return arguments[place + 1]
        if argument.startswith(f"{option}="):
            return argument.partition("=")[2]
    return None
