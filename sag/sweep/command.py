"""Commands: W&B's macros expanded, and what a call of `sag sweep` adds to them."""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from sag.errors import SagError
from sag.files import read_yaml
from sag.sweep.definition import Point, Sweep

MACRO = re.compile(r"\$\{(\w+)\}")
ENVIRONMENT_MACRO = re.compile(r"\$\{envvar:(\w+)\}")
ROWS_ONLY = ("model.", "components.", "trainer.max_", "trainer.limit_")
"""Keys that a preparation is not given: its method is another, and encoders of a shortened run would be kept."""


@dataclass(frozen=True)
class Additions:
    """What a call adds to every command, before the row's own arguments.

    Attributes:
        configs: files laid over those of the sweep file.
        settings: `key=value`, after the configs.
        pretrained: folder of another sweep, in whose checkpoints the rows of the same names start.
    """

    configs: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    pretrained: Path | None = None

    def arguments(self, settings: Sequence[str] | None = None, between: Sequence[str] = ()) -> list[str]:
        """The configs, what stands `between`, then the settings."""
        chosen = self.settings if settings is None else settings
        return [f"--config={config}" for config in self.configs] + [*between] + [f"--{setting}" for setting in chosen]


def written(value: Any) -> str:
    """A parameter's value as YAML reads it back: `true`, `false`, `null`, lists as JSON."""
    return value if isinstance(value, str) else json.dumps(value)


def row_command(sweep: Sweep, point: Point, additions: Additions) -> list[str]:
    """The command of one row: the file's own arguments, the additions, the row's arguments.

    Raises:
        SagError: the command has a macro that is not known.
    """
    return _expand(sweep, sweep.command, point, additions.arguments())


def preparation_command(sweep: Sweep, subcommand: str, overlay: Sequence[str], additions: Additions) -> list[str]:
    """The command of a preparation: that of the rows with another subcommand for `run` and an overlay of configs.

    Raises:
        SagError: the command has a macro that is not known.
    """
    place = sweep.command.index("run")
    template = (*sweep.command[:place], subcommand, *sweep.command[place + 1 :])
    settings = [s for s in additions.settings if not s.startswith(ROWS_ONLY)]
    return _expand(sweep, template, {}, additions.arguments(settings, between=overlay))


def _expand(sweep: Sweep, template: Sequence[str], point: Point, added: Sequence[str]) -> list[str]:
    """Replaces macros as W&B's agent does; the additions go before the first macro of arguments, else to the end."""
    macros = {
        "env": ["/usr/bin/env"],
        "interpreter": [sys.executable],
        "program": [sweep.program],
        "args": [f"--{name}={written(value)}" for name, value in point.items()],
        "args_no_hyphens": [f"{name}={written(value)}" for name, value in point.items()],
    }
    places = [i for i, part in enumerate(template) if part.startswith("${args")]
    place = places[0] if places else len(template)
    expanded: list[str] = []
    for part in (*template[:place], *added, *template[place:]):
        found = MACRO.fullmatch(part)
        if found and found[1] not in macros:
            raise SagError(
                f"{sweep.path}: macro {part} is not known here; use {', '.join(f'${{{m}}}' for m in macros)}"
            )
        expanded += macros[found[1]] if found else [ENVIRONMENT_MACRO.sub(_environment, part)]
    return expanded


def _environment(match: re.Match[str]) -> str:
    """As W&B does it: the variable's value, or its name where it is not set."""
    return os.environ.get(match[1], match[1])


def command_hash(command: Sequence[str], after: str = "") -> str:
    """A fingerprint of what a command does: its arguments, the bytes of every config it names, what it builds on.

    The interpreter's place is left out, so that a moved virtual environment does not run everything again. A config of
    components alone counts as its flags, so that sweeps over configs and over flags share rows.

    Args:
        command: the command, without the folder it writes to.
        after: fingerprint of the command whose results this one reads.

    Raises:
        SagError: a config file does not exist.
    """
    digest = hashlib.sha256(after.encode())
    for part in chain.from_iterable(map(_with_component_flags, command)):
        if part != sys.executable:
            digest.update(part.encode() + b"\0")
        config = part.rpartition("=")[2]
        if config.endswith((".yaml", ".yml")):
            digest.update(_config_bytes(Path(config)))
    return digest.hexdigest()[:16]


def _with_component_flags(part: str) -> list[str]:
    """A part of a command, or, where it names a config of components alone, the flags that say the same."""
    option, _, path = part.partition("=")
    if option != "--config":
        return [part]
    try:
        content = read_yaml(Path(path))
    except SagError:  # whoever runs it says so
        return [part]
    if not isinstance(content, dict) or list(content) != ["components"] or not isinstance(content["components"], dict):
        return [part]
    return [f"--components.{name}={written(value)}" for name, value in content["components"].items()]


def _config_bytes(path: Path) -> bytes:
    if not path.is_file():
        raise SagError(f"config file {path} does not exist here; call sag sweep from the folder that holds configs/")
    return path.read_bytes()
