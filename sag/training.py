"""`sag fit | run | validate | test | predict`: Lightning's command line over the configs."""

from __future__ import annotations

import logging
import sys
import warnings
from pathlib import Path
from typing import Any

import torch
import wandb
from jsonargparse import set_parsing_settings
from lightning.pytorch.cli import LightningArgumentParser, LightningCLI, SaveConfigCallback

from sag.callbacks import MetricsFile, PredictionFile, ProgressFile
from sag.components import Components
from sag.data.base import MotionDataModule
from sag.errors import SagError
from sag.methods.base import Method
from sag.parallel import first_process_speaks
from sag.parsing import LINKS, one_sentence_each
from sag.saving import LastCheckpoint
from sag.trainer import Trainer


class SaveConfig(SaveConfigCallback):
    """Saves the config under its command's name, so that a test does not overwrite what was trained."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.overwrite = True

    def setup(self, trainer: Any, pl_module: Any, stage: str) -> None:
        """Names the file after the stage that runs first."""
        self.config_filename = f"config.{getattr(stage, 'value', stage)}.yaml"
        super().setup(trainer, pl_module, stage)


class TrainingCLI(LightningCLI):
    """Lightning's command line with the four letters as options of their own."""

    def add_arguments_to_parser(self, parser: LightningArgumentParser) -> None:
        """Adds `--components` and `--encoder_width`, and what methods take from the data."""
        parser.add_argument("--components", type=Components | None, default=None, help="which of M, D, P, C are on")
        parser.add_argument("--encoder_width", type=float, default=1.0, help="width of Motion FID's encoders")
        parser.add_argument(
            "--pretrained", type=Path | None, default=None, help="checkpoint of other data in which training starts"
        )
        parser.link_arguments("components", "model.init_args.components")
        parser.link_arguments("encoder_width", "model.init_args.width")
        for name in LINKS:
            parser.link_arguments(f"data.init_args.{name}", f"model.init_args.{name}")

    @staticmethod
    def subcommands() -> dict[str, set[str]]:
        """Lightning's, without tune, and `run`."""
        skipped = {"model", "dataloaders", "datamodule"}
        fit = {"model", "train_dataloaders", "val_dataloaders", "datamodule"}
        return {"fit": fit, "run": skipped, "validate": skipped, "test": skipped, "predict": skipped}

    def _parse_ckpt_path(self) -> None:
        """Leaves the config alone: by default a checkpoint's own hyper-parameters would overrule it."""

    def instantiate_classes(self) -> None:
        """Tells the method where its training starts."""
        super().instantiate_classes()
        start = self._get(self.config_init, "pretrained")
        if start is not None and not isinstance(self.model, Method):
            raise SagError(f"--pretrained is set, but {type(self.model).__name__} is no method: it starts anew")
        if isinstance(self.model, Method):
            self.model.pretrained = start

    def before_instantiate_classes(self) -> None:
        """Refuses components on a method that has none."""
        config = self.config[self.subcommand]
        kind = config.model.class_path
        if config.components is not None and "components" not in config.model.init_args:
            raise SagError(f"--components is set, but {kind} has no components; leave the row's config out")


def train(arguments: list[str]) -> int:
    """Parses and runs; every mistake in options or configs becomes one sentence."""
    set_parsing_settings(omegaconf_absolute_to_relative_paths=True)
    _leave_unsaid()
    torch.set_flush_denormal(True)  # tiny numbers cost twenty times as much on some processors
    try:
        with first_process_speaks(), one_sentence_each():
            TrainingCLI(
                datamodule_class=MotionDataModule,
                subclass_mode_data=True,
                subclass_mode_model=True,
                trainer_class=Trainer,
                trainer_defaults={"callbacks": [LastCheckpoint(), ProgressFile(), MetricsFile(), PredictionFile()]},
                auto_configure_optimizers=False,
                save_config_callback=SaveConfig,
                parser_kwargs={"parser_mode": "omegaconf+", "exit_on_error": False, "allow_abbrev": False},
                args=None if arguments == sys.argv[1:] else arguments,
            )
    finally:
        torch.set_flush_denormal(False)
        wandb.finish()
    return 0


def _leave_unsaid() -> None:
    """Leaves out what libraries say of things that are as they should be."""
    logging.getLogger("lightning.pytorch.utilities.rank_zero").setLevel(logging.WARNING)  # tips and greetings
    for message in (
        "It is recommended to use .*sync_dist=True",  # figures are of all processes before they are logged
        "(?s).*was called before the ``update`` method",  # a test may have fewer batches than processes
        "Grad strides do not match bucket view strides",  # channels-last weights of 1 x 1
        "The `srun` command is available",  # sweeps go to SLURM by themselves
        r"`isinstance\(treespec, LeafSpec\)` is deprecated",  # Lightning's affair
    ):
        warnings.filterwarnings("ignore", message)
