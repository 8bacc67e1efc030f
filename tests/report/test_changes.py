"""Every row of a sweep over settings against its start."""

import csv
import io
import math

import pytest

from sag.report import main
from sag.report.changes import TITLE, changes_of, changes_table
from sag.report.lines import lines_of
from sag.report.results import read_results

SCATTER = (0.0, 0.05, -0.05)


@pytest.fixture
def settings(runs):
    """A sweep with a start, a setting that halves Motion FID and one that does nothing, three seeds of each."""
    for row, factor in {"start": 1.0, "steps_3": 0.5, "kernel_squared": 1.0}.items():
        for seed, shift in enumerate(SCATTER):
            runs.add(f"{row}-s{seed}", 20 * factor * math.exp(shift), 0.9, seed=seed, components=None)
    runs.add_truth()
    return runs


def changes(runs):
    return {(c.row, c.measure.metric): c.difference for c in changes_of(lines_of(read_results(runs.folder)))}


def test_every_other_row_is_compared_with_the_start(settings):
    found = changes(settings)
    assert {row for row, _ in found} == {"steps_3", "kernel_squared"}
    halved, same = found["steps_3", "motion_fid/average"], found["kernel_squared", "motion_fid/average"]
    assert halved.value == pytest.approx(math.log(0.5)) and halved.excludes_zero
    assert same.value == pytest.approx(0, abs=1e-9) and not same.excludes_zero
    assert same.freedom == 6


def test_the_start_stands_before_its_changes(settings):
    names = [line.name for line in lines_of(read_results(settings.folder))]
    assert names == ["start", "kernel_squared", "steps_3", "ground_truth"]


def test_the_table_and_the_csv_say_the_same(settings):
    assert main([str(settings.folder)]) == 0
    text = (settings.folder / "table.md").read_text(encoding="utf-8").partition(f"## {TITLE}")[2]
    (line,) = [line for line in text.splitlines() if line.startswith("| steps 3")]
    rows = list(csv.DictReader(io.StringIO((settings.folder / "statistics.csv").read_text())))
    (row,) = [row for row in rows if (row["subject"], row["measure"]) == ("start to steps_3", "motion_fid/average")]
    assert row["kind"] == "changes" and row["scale"] == "ratio" and float(row["estimate"]) == pytest.approx(0.5)
    assert f"**×0.500 [{float(row['low']):.3f}, {float(row['high']):.3f}]**" in line
    assert "6 degrees of freedom" in text


def test_one_seed_has_no_such_table_and_neither_has_a_sweep_without_a_start(runs):
    runs.add("start", components=None)
    runs.add("steps_3", components=None)
    assert changes_table(changes_of(lines_of(read_results(runs.folder)))) is None
    for name in ("a-s0", "a-s1", "b-s0", "b-s1"):
        runs.add(name, components=None, seed=int(name[-1]))
    lines = [line for line in lines_of(read_results(runs.folder)) if line.name != "start"]
    assert changes_of(lines) == []


def test_nan_stays_nan_and_the_others_are_compared_without_it(settings):
    settings.add("kernel_squared-s1", math.nan, seed=1, components=None)
    found = changes(settings)
    assert math.isnan(found["kernel_squared", "motion_fid/average"].value)
    assert found["steps_3", "motion_fid/average"].freedom == 4
    assert "NaN" in str(changes_table(changes_of(lines_of(read_results(settings.folder)))))
