"""Tables of figures that are ours, beside those of the paper, and the row that is blind to the scene."""

import io
import re

import pytest
from rich.console import Console

from sag.report import agreement, letters, main
from sag.report.columns import Column, Group
from sag.report.facts import WHAT_BLIND_IS
from sag.report.lines import Figure, lines_of, twin_ratios
from sag.report.results import read_results
from sag.report.sections import COMPANIONS, SEES_MORE
from sag.report.table import report_of
from sag.report.terminal import show

TITLES = [section.title for section in (SEES_MORE, COMPANIONS)]
EVIDENCE = [agreement.TITLE, letters.OWN_TITLE, letters.MAIN_TITLE, letters.TOGETHER_TITLE]
"""What one seed of all 16 rows gives: nothing is paired."""


def tables(runs, whole=False):
    return report_of("title", lines_of(read_results(runs.folder)), whole).tables


def cells(table, row):
    """Cell by metric of a row; what explains its name is left out."""
    (found,) = [r for r in table.rows if r.cells[0].text.partition(":")[0] == row]
    return {column.metric: cell for column, cell in zip(table.columns, found.cells) if not column.paper}


@pytest.fixture
def measured(whole):
    whole.add_blind()
    whole.measure_more()
    return whole


def test_old_runs_have_the_first_table_alone(whole):
    (table,) = tables(whole)
    assert "95 %" not in [column.heading for column in table.columns]
    assert main([str(whole.folder)]) == 0
    for name in ("table.md", "table.html", "table.tex"):
        assert not any(title in (whole.folder / name).read_text() for title in TITLES)


def test_every_figure_has_its_column(measured):
    first, *further = tables(measured)
    assert [table.title for table in further] == TITLES
    for table, section in zip(further, (SEES_MORE, COMPANIONS)):
        assert table.columns[1:] == section.columns
    assert cells(first, "mdpc")["motion_fid_interval/low"].text == "14.6–19.5"


def test_no_figure_stands_in_two_columns_and_none_of_ours_under_the_papers(measured):
    shown = [c.metric for table in tables(measured) for c in table.columns if c.metric and not c.paper]
    assert len(shown) == len(set(shown))
    assert {name.partition("/")[0] for name in shown[:9]} == {"motion_fid", "motion_fid_interval", "non_collision"}


def test_figures_stand_in_the_units_of_their_headings(measured):
    _, sees_more, companions = tables(measured)
    row = cells(sees_more, "mdpc") | cells(companions, "mdpc")
    wanted = {
        "penetration/root": "5.0", "penetration/depth": "12.3", "floor/error": "30.0", "depth_error/delta1": "60.0",
        "foot_skate": "0.800", "foot_contact": "50.0", "bone_drift": "15.00", "jerk": "2,400",
        "best_of/path_2": "0.400", "best_of/pose_2": "100",
    }  # fmt: skip
    assert {name: row[name].text for name in wanted} == wanted


def test_the_best_is_marked_only_where_better_is_clear(measured):
    _, sees_more, companions = tables(measured)
    looks = {c.metric: cells(sees_more, "mdpc")[c.metric].look for c in sees_more.columns[1:]}
    assert looks["velocity_frechet"] == looks["penetration/share"] == "best"
    assert looks["collisions/elsewhere"] == "plain"
    assert {cells(companions, "mdpc")[name].look for name in ("jerk", "diversity/pairwise")} == {"plain"}
    for table in (sees_more, companions):
        assert all(("↓" in c.label or "↑" in c.label) == bool(c.better) for c in table.columns)


def test_equal_as_shown_is_equally_good(runs):
    for row, fid in {"m": 20.01, "md": 20.02, "mp": 21.0}.items():
        runs.add(row, fid)
    (table,) = tables(runs)
    assert [cells(table, row)["motion_fid/average"].look for row in ("m", "md", "mp")] == ["best", "best", "plain"]


def test_a_missing_figure_is_a_dash_and_a_missing_column_is_left_out(measured):
    measured.add("mc")
    _, sees_more, _ = tables(measured)
    assert cells(sees_more, "mc")["velocity_frechet"].text == "–"
    for path in measured.folder.glob("*/metrics.json"):
        path.write_text(re.sub(r'"(depth_error|depth_probe|best_of|diversity)/', r'"raw/\1/', path.read_text()))
    _, sees_more, companions = tables(measured)
    shown = {column.metric.partition("/")[0] for table in (sees_more, companions) for column in table.columns}
    assert not shown & {"depth_error", "best_of", "diversity"}
    assert "Depth:" not in sees_more.legend and "Collisions:" in sees_more.legend


def test_a_figure_that_some_seeds_lack_is_not_shown(runs):
    runs.add("m-s0")
    runs.add("md-s0")
    runs.measure_more()
    runs.add("m-s1", seed=1)
    _, sees_more, _ = tables(runs)
    assert cells(sees_more, "m")["velocity_frechet"].text == "–"
    assert cells(sees_more, "md")["velocity_frechet"].text == "40.0"


def test_ground_truth_and_floors_stand_at_the_bottom(measured):
    _, sees_more, companions = tables(measured)
    names = [row.cells[0].text for row in sees_more.rows]
    assert names[-3:] == ["blind: scene feature zeroed", "ground truth", "floor: real against real, halves"]
    floor = cells(sees_more, "floor")
    assert (floor["velocity_frechet"].text, floor["scene_frechet"].text) == ("0.600", "1.40")
    assert not floor["collisions/ratio"].text
    assert companions.rows[-1].cells[0].text == "ground truth", "nothing there has a floor"


def test_the_blind_row_is_neither_the_best_nor_a_twin(runs):
    for row, fid in {"none": 100.0, "m": 20.0}.items():
        runs.add(row, fid)
    runs.add_blind(fid=5.0, share=0.99)
    runs.add_truth()
    lines = lines_of(read_results(runs.folder))
    assert [(line.name, line.kind) for line in lines] == [
        ("none", "without"), ("m", "with"), ("blind", "blind"), ("ground_truth", "truth"),
    ]  # fmt: skip
    assert twin_ratios(lines) == {"none / m": 5.0}
    (table,) = tables(runs)
    assert cells(table, "blind")["motion_fid/average"].look == "plain"
    assert cells(table, "m")["motion_fid/average"].look == "best"
    assert main([str(runs.folder)]) == 0
    assert WHAT_BLIND_IS in (runs.folder / "table.md").read_text()
    assert "blind (scene feature zeroed)" in (runs.folder / "plot.svg").read_text()


def test_blind_rows_of_several_settings_and_seeds(runs):
    for seed, fid in enumerate((10.0, 14.0)):
        runs.add_blind(fid, name=f"blind-rate=1-s{seed}", seed=seed)
    runs.fail("blind-rate=2-s0")
    lines = lines_of(read_results(runs.folder))
    assert [(line.name, line.kind, len(line.finished)) for line in lines] == [
        ("blind-rate=1", "blind", 2), ("blind-rate=2", "blind", 0),
    ]  # fmt: skip


def test_latex_has_a_whole_table_for_each(measured):
    assert main([str(measured.folder)]) == 0
    text = (measured.folder / "table.tex").read_text()
    assert text.isascii() and text.count(r"\begin{table*}") == text.count(r"\end{table*}") == 3 + len(EVIDENCE)
    assert text.count("Seeds:") == 1, "facts are said once"
    for table in text.split(r"\begin{tabular}")[1:]:
        columns = re.match(r"\{([lcr]+)\}", table)[1]
        rows = [line for line in table.splitlines() if line.endswith(r"\\") and "multicolumn" not in line]
        assert {len(re.findall(r"(?<!\\)&", row)) + 1 for row in rows} == {len(columns)}


def test_markdown_and_html_have_every_table(measured):
    assert main([str(measured.folder)]) == 0
    text, page = ((measured.folder / name).read_text() for name in ("table.md", "table.html"))
    assert [line[3:] for line in text.splitlines() if line.startswith("## ")] == [*TITLES, *EVIDENCE]
    assert "| Fréchet velocity ↓ |" in text and "| pose (mm) 0.5 s ↓ |" in text
    assert page.count("<table>") == page.count("<h2>") + 1 == 3 + len(EVIDENCE)


def test_csv_keeps_our_figures_in_their_own_units(measured):
    assert main([str(measured.folder)]) == 0
    head, *_ = (measured.folder / "table.csv").read_text().splitlines()
    names = head.split(",")
    assert names.index("non_collision/average") < names.index("velocity_frechet") < names.index("best_of/pose_2")
    assert "motion_fid_interval/high" in names and "velocity_frechet_floor" in names


@pytest.mark.parametrize(("width", "further", "interval"), [(82, 0, False), (110, 2, False), (300, 2, True)])
def test_a_narrow_terminal_has_fewer_columns_and_no_table_that_does_not_fit(measured, width, further, interval):
    text = io.StringIO()
    show(report_of("title", lines_of(read_results(measured.folder))), Console(file=text, width=width))
    said = text.getvalue()
    assert sum(title in said for title in TITLES) == further
    assert ("95 %" in said) == interval
    assert sum(line.strip().startswith("mdpc") for line in said.splitlines()) == 1 + further
    assert "…" not in said


def test_counts_of_a_newer_protocol_are_said(runs):
    runs.add("m", protocol={"samples": 5, "groups": "18 rooms", "resamples": 200})
    assert main([str(runs.folder)]) == 0
    text = (runs.folder / "table.md").read_text()
    assert "floors and intervals from 18 rooms, 200 resamples (interval), K = 5 samples" in text


@pytest.mark.parametrize(
    ("value", "text"), [(0.12345, "0.123"), (1.2345, "1.23"), (12.345, "12.3"), (1234.5, "1,234"), (-1e-9, "0.000")]
)
def test_figures_have_about_three_digits(value, text):
    assert Column(Group(), "x").written(Figure(value)) == text


def test_an_interval_has_the_unit_and_the_digits_of_its_mean():
    assert Column(Group(), "x mm", factor=1000, digits=1).written(Figure(0.0123, 0.0011, 3)) == "12.3 ± 2.7"
