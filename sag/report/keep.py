"""Results that stay: a sweep's figures, configs and states in a folder small enough to be committed."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from sag.errors import SagError
from sag.files import read_yaml, write_json, write_whole, writing_in
from sag.report.portable import portable, portable_command
from sag.report.results import SHEET, read_json, run_folders

CONFIG = "config.fit.yaml"
ESSENTIALS = ("state", "reason", "returncode", "command_hash", "started", "ended")
"""What is kept of a row's status beside its command: not its process, nor where it was copied from."""

KEPT = {"metrics.json", CONFIG, "status.json", SHEET}
REPORT = {
    "table.md", "table.csv", "table.tex", "table.html", "plot.png", "plot.svg", "statistics.csv", "letters.png",
    "letters.svg",
}  # fmt: skip
"""Files of a report in the folder of one sweep."""


def keep(folder: Path, kept: Path, overwrite: bool = False) -> list[str]:
    """Copies what a report needs, and how each row was run, into a folder of their own; says which rows.

    A finished row leaves its figures, its config and its state; another one its state, so that it stays visible. No
    absolute path is kept: see `portable`. The folder is whole or as it was.

    Args:
        folder: what a sweep wrote.
        kept: the folder to be.
        overwrite: whether one that holds kept results is replaced.

    Raises:
        SagError: the folder is there and `overwrite` is off, it holds something else, or it cannot be written.
    """
    _check_place(folder, kept, overwrite)
    rows = run_folders(folder)
    with writing_in(kept, "name another folder with --keep"):
        kept.parent.mkdir(parents=True, exist_ok=True)
        partial = Path(tempfile.mkdtemp(prefix=f".{kept.name}.", dir=kept.parent))
        try:
            for row in rows:
                _keep_row(row, partial / row.name)
            partial.chmod(0o777 & ~_umask())
            if kept.exists():
                shutil.rmtree(kept)
            partial.replace(kept)
        finally:
            shutil.rmtree(partial, ignore_errors=True)
    return [row.name for row in rows]


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _check_place(folder: Path, kept: Path, overwrite: bool) -> None:
    """Refuses to replace what is not kept results, or was not asked to be replaced."""
    source, target = folder.resolve(), kept.resolve()
    if source == target or source in target.parents or target in source.parents:
        raise SagError(f"--keep {kept} and {folder} lie in each other; keep results in a folder of their own")
    if not kept.exists() and not kept.is_symlink():
        return
    if not kept.is_dir() or kept.is_symlink():
        raise SagError(f"--keep {kept} is no folder; name another one")
    foreign = next((path for path in sorted(kept.rglob("*")) if not _is_kept(path.relative_to(kept), path)), None)
    if foreign is not None:
        raise SagError(f"--keep {kept} holds {foreign.relative_to(kept)}, which is no kept result; name another folder")
    if any(kept.iterdir()) and not overwrite:
        raise SagError(f"--keep {kept} holds results already; add --overwrite to replace them, or name another folder")


def _is_kept(path: Path, place: Path) -> bool:
    """Whether this is what `keep` and a report write."""
    if place.is_dir():
        return len(path.parts) == 1
    return path.name in (REPORT if len(path.parts) == 1 else KEPT) and len(path.parts) <= 2


def _keep_row(row: Path, kept: Path) -> None:
    status = read_json(row / "status.json") if (row / "status.json").is_file() else {}
    if status:
        write_json(kept / "status.json", _essentials(status))
    if status.get("state", "finished") != "finished":
        return
    if (row / "metrics.json").is_file():
        write_json(kept / "metrics.json", portable(read_json(row / "metrics.json"), Path.cwd()))
    if (row / SHEET).is_file():
        shutil.copyfile(row / SHEET, kept / SHEET)
    if (row / CONFIG).is_file():
        config = portable(read_yaml(row / CONFIG), Path.cwd())
        text = yaml.safe_dump(config, sort_keys=False, allow_unicode=True)
        write_whole(kept / CONFIG, lambda file: file.write(text.encode()))


def _essentials(status: Mapping[str, Any]) -> dict[str, Any]:
    kept = portable({name: status[name] for name in ESSENTIALS if name in status}, Path.cwd())
    return {**kept, "command": portable_command([str(part) for part in status.get("command", [])], Path.cwd())}
