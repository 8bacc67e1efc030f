"""`sag report --wandb`: the table is in W&B's own offline run, with all that the CSV file has."""

from __future__ import annotations

import csv
import json
import math
import struct
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import wandb
from wandb.proto.wandb_internal_pb2 import Record

from sag.report import main

BLOCK = 32768
"""Bytes of a block of LevelDB's log, the format of W&B's file."""


def records(path: Path) -> Iterator[Record]:
    """What W&B would send, read from the file of an offline run."""
    content = path.read_bytes()
    assert content[:4] in (b"", b":W&B")
    place, parts = 7, b""
    while place < len(content):
        left = BLOCK - place % BLOCK
        if left < 7:
            place += left
            continue
        if place + 7 > len(content):
            return
        _, length, kind = struct.unpack_from("<IHB", content, place)
        if place + 7 + length > len(content):
            return  # it is being written
        parts += content[place + 7 : place + 7 + length]
        place += 7 + length
        if kind in (1, 4):  # whole, or the last part
            yield Record.FromString(parts)
            parts = b""


def whole(run: Path, patience: float = 30.0) -> list[Record]:
    """All records of a run that has ended; W&B's own process writes them, a moment after the run does."""
    (file,) = run.glob("*.wandb")
    until = time.monotonic() + patience
    while time.monotonic() < until:
        found = list(records(file))
        if found and found[-1].HasField("exit"):
            return found
        time.sleep(0.1)
    raise AssertionError(f"{file} was not finished after {patience:g} s")


def offline(out: Path) -> tuple[Path, dict[str, Any], str]:
    """Folder of the one offline run, what it logged last, and its name."""
    (run,) = (out / "wandb").glob("offline-run-*")
    logged, name = {}, ""
    for record in whole(run):
        if record.HasField("run"):
            name = record.run.display_name
            assert (record.run.project, record.run.job_type) == ("sag", "report")
        for item in record.history.item:
            logged[item.key or ".".join(item.nested_key)] = json.loads(item.value_json)
    return run, logged, name


def read_table(run: Path, logged: dict[str, Any], name: str) -> dict[str, Any]:
    """A table as the run's folder holds it, found by what was logged."""
    told = {key.removeprefix(f"{name}."): value for key, value in logged.items() if key.startswith(f"{name}.")}
    told = told or logged[name]
    assert told["_type"] == "table-file"
    return json.loads((run / "files" / told["path"]).read_text())


@pytest.fixture
def reported(runs, monkeypatch, capsys: pytest.CaptureFixture[str]) -> Iterator[Path]:
    """Six rows of two seeds, one failed and one with NaN, reported with `--wandb`."""
    monkeypatch.delenv("WANDB_MODE", raising=False)
    for place, row in enumerate(("none", "m", "md", "mdc", "mdp", "mdpc")):
        for seed in range(2):
            runs.add(f"{row}-s{seed}", 100.0 / (place + 1) + seed, seed=seed)
    runs.fail("mdpc-s2")
    path = runs.folder / "mdp-s0/metrics.json"
    path.write_text(path.read_text().replace('"non_collision/30": 0.92', '"non_collision/30": null'))
    assert main([str(runs.folder), "--wandb"]) == 0
    assert f"W&B: {runs.folder}/wandb/offline-run-" in capsys.readouterr().out
    yield runs.folder
    wandb.teardown()  # or it goes on in the mode in which it first was asked


def test_the_tables_are_read_back_from_the_offline_run(reported: Path) -> None:
    run, logged, name = offline(reported)
    assert name and name in (reported / "table.md").read_text()
    for title, least in (("table", 6), ("statistics", 10)):
        with (reported / f"{title}.csv").open() as file:
            header, *rows = csv.reader(file)
        found = read_table(run, logged, title)
        assert found["columns"] == header and len(found["data"]) == len(rows) >= least
        assert all(same(*pair) for row, wanted in zip(found["data"], rows) for pair in zip(row, wanted))


def test_numbers_are_numbers(reported: Path) -> None:
    run, logged, _ = offline(reported)
    table = read_table(run, logged, "table")
    cells = {name: [row[place] for row in table["data"]] for place, name in enumerate(table["columns"])}
    assert cells["motion_fid/average"][:2] == [100.5, 50.5]
    assert cells["row"][:2] == ["none", "m"] and cells["M"][:2] == [0, 1]
    assert any((isinstance(cell, float) and math.isnan(cell)) or cell == "NaN" for cell in cells["non_collision/30"])
    assert {key.partition(".")[0] for key in logged} >= {"table", "statistics", "plot", "letters"}


def same(found: Any, wanted: str) -> bool:
    """Whether a cell of JSON says what a cell of CSV says; W&B writes NaN as text."""
    if found is None or wanted == "":
        return found is None and wanted == ""
    if wanted == "nan":
        return found == "NaN" or (isinstance(found, float) and math.isnan(found))
    return found == wanted or float(found) == float(wanted)


def test_without_the_flag_there_is_no_run(runs) -> None:
    runs.add("m")
    assert main([str(runs.folder)]) == 0
    assert not (runs.folder / "wandb").exists()
