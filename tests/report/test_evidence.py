"""Neighbours, agreement and letters in whole reports."""

import csv
import io
import math

import pytest
from PIL import Image

from sag.letters import LETTERS, components_of
from sag.report import main
from sag.report.agreement import TITLE as AGREEMENT
from sag.report.agreement import agreements_of
from sag.report.estimates import written_p
from sag.report.letters import MAIN_TITLE, OWN_TITLE
from sag.report.lines import lines_of
from sag.report.neighbours import NEIGHBOURS, steps_of
from sag.report.neighbours import TITLE as NEIGHBOURING
from sag.report.paper import GTA_IM, PROX, TABLE_1_MOTION_FID
from sag.report.results import read_results

SHIFTS = (0.0, 0.3, -0.2, 0.1, -0.1)


@pytest.fixture
def seeded(runs):
    """Table 1 with the paper's own averages, five seeds, each of which scales all rows alike."""
    for row, (*_, fid) in TABLE_1_MOTION_FID.items():
        share = GTA_IM.cells(row).get("non_collision/average", 0.8)
        for seed, shift in enumerate(SHIFTS):
            runs.add(f"{row}-s{seed}", fid * math.exp(shift), share - shift / 100, seed=seed)
    runs.add_truth()
    return runs


def lines(runs):
    return lines_of(read_results(runs.folder))


def section(text, title):
    """Cells of a table of a Markdown report by the first one, with its legend."""
    part = text.partition(f"## {title}\n")[2].partition("\n## ")[0]
    rows = [[cell.strip() for cell in line[1:-1].split("|")] for line in part.splitlines() if line[:1] == "|"]
    return {row[0]: dict(zip(rows[0], row)) for row in rows[2:]}, part


def written(runs, name="table.md"):
    assert main([str(runs.folder)]) == 0
    return (runs.folder / name).read_text(encoding="utf-8")


def test_neighbours_are_paired_by_seed(seeded):
    steps = {(s.before, s.after, s.measure.metric): s for s in steps_of(lines(seeded), GTA_IM)}
    assert {pair[:2] for pair in steps} == set(NEIGHBOURS)
    for (before, _, metric), step in steps.items():
        assert step.difference.count == 5
        if metric == "motion_fid/average" or before != "none":
            assert step.difference.value == pytest.approx(step.printed, abs=1e-9), "seeds scale both rows alike"
    assert steps["none", "m", "motion_fid/average"].difference.high < math.log(0.28)
    assert steps["none", "m", "non_collision/average"].printed is None


def test_the_same_seeds_are_compared_and_no_others(seeded):
    seeded.fail("md-s4")
    seeded.add("m-s7", 1e6, seed=7)
    steps = {(s.before, s.after): s for s in steps_of(lines(seeded), GTA_IM) if s.measure.is_ratio}
    assert steps["m", "md"].difference.count == 4
    assert steps["m", "md"].difference.value == pytest.approx(steps["m", "md"].printed)


def test_the_table_of_neighbours(seeded):
    rows, legend = section(written(seeded), NEIGHBOURING)
    assert list(rows) == [" → ".join(pair) for pair in NEIGHBOURS]
    first = rows["none → m"]
    assert first["FID change"] == "**×0.279**" == f"**{first['FID paper']}**"
    assert (first["FID n"], first["FID p flip"]) == ("5", "0.062")
    assert first["NC paper"] == "" and rows["m → md"]["NC paper"] == "+0.011"
    assert "paired t-test" in legend and "0.0625 for 5" in legend


def test_one_seed_is_compared_with_nothing(runs):
    for row in ("none", "m", "md"):
        runs.add(row)
    text = written(runs)
    assert NEIGHBOURING not in text and OWN_TITLE not in text and "[" not in text
    assert not (runs.folder / "letters.png").exists()


def test_the_papers_own_figures_agree_with_the_paper(seeded):
    fid, share = agreements_of(lines(seeded), GTA_IM)
    assert (fid.tau, fid.p) == pytest.approx((1.0, 2 / math.factorial(6)))
    assert fid.by_seed == pytest.approx((1.0,) * 5) and (fid.low, fid.high) == pytest.approx((1.0, 1.0))
    assert (share.tau, len(share.rows), share.pairs, share.agreeing) == (pytest.approx(1.0), 5, 10, 10)
    rows, legend = section(written(seeded), AGREEMENT)
    assert rows["Motion FID ↓"]["pairs in order"] == "15 of 15" and rows["Motion FID ↓"]["τ"] == "1.00"
    assert "resampled" in rows["Motion FID ↓"] and "drawn again" in legend


def test_the_reverse_order_is_minus_one(runs):
    for row, (*_, fid) in TABLE_1_MOTION_FID.items():
        runs.add(row, 1000 / fid)
    (fid, _) = agreements_of(lines(runs), GTA_IM)
    assert fid.tau == pytest.approx(-1.0) and fid.agreeing == 0
    assert fid.by_seed == () and fid.low is None, "one seed has no distribution"
    assert "resampled" not in section(written(runs), AGREEMENT)[1].lower()


def test_two_rows_and_nan_have_no_order(runs):
    runs.add("none", 100.0)
    runs.add("m", 20.0)
    assert not agreements_of(lines(runs), GTA_IM)
    runs.add("md", math.nan)
    fid = next(iter(agreements_of(lines(runs), GTA_IM)))
    assert math.isnan(fid.tau)
    assert section(written(runs), AGREEMENT)[0]["Motion FID ↓"]["τ"] == "**NaN**"


def test_prox_is_compared_with_the_papers_prox(runs):
    for row, fid in {"hp_gan": 3.0, "none": 2.0, "md": 1.0}.items():
        runs.add(row, fid, components=components_of(row), data={"name": "prox"})
    fid, *_ = agreements_of(lines(runs), PROX)
    assert fid.tau == pytest.approx(1.0) and "hp_gan" in fid.rows


def factorial(runs, seeds):
    for place in range(16):
        row = "".join(letter for bit, letter in enumerate("mdpc") if place >> bit & 1) or "none"
        for seed in range(seeds):
            fid = (20.0 if "m" in row else 100.0) * math.exp(0.01 * ((place * 7 + seed * 3) % 5 - 2))
            runs.add(f"{row}-s{seed}", fid, 0.8 + 0.01 * ((place * 3 + seed) % 4), seed=seed)
    runs.measure_more()
    return runs


def test_letters_of_all_16_rows(runs):
    text = written(factorial(runs, 2))
    main_effects, legend = section(text, MAIN_TITLE)
    assert main_effects["Motion FID ↓"]["M"].startswith("**×0.2")
    assert [*main_effects["Motion FID ↓"]][1:] == list(LETTERS.values())
    assert "error is that of seeds" in legend and "Twins" not in legend
    own, _ = section(text, OWN_TITLE)
    assert own["M"]["verdict"] == "**holds**" and own["C"]["verdict"] != "not measured"


def test_one_seed_of_16_says_where_its_error_comes_from(whole):
    _, legend = section(written(whole), MAIN_TITLE)
    assert "One seed: the error is taken from three- and four-way interactions (5 degrees of freedom)" in legend


def test_the_plot_has_a_panel_for_each_measure(runs):
    text = written(factorial(runs, 2), "letters.svg")
    for name in (
        "Motion FID ↓",
        "inside furniture ↓",
        "non-collision ↑",
        "P×C",
        "better beyond chance",
        "ratio, on / off",
    ):
        assert name in text
    with Image.open(runs.folder / "letters.png") as picture:
        assert picture.width > 1500
    assert (runs.folder / "table.html").read_text(encoding="utf-8").count("<svg") == 2


def test_every_estimate_is_in_the_spreadsheet(seeded):
    rows = list(csv.DictReader(io.StringIO(written(seeded, "statistics.csv"))))
    kinds = [row["kind"] for row in rows]
    assert kinds.count("neighbours") == 12 and kinds.count("agreement") == 2 and kinds.count("letters") >= 8
    step = next(row for row in rows if row["subject"] == "none to m")
    assert float(step["estimate"]) == pytest.approx(33.1 / 118.6) and step["scale"] == "ratio"
    assert float(step["low"]) <= float(step["estimate"]) <= float(step["high"])
    letter = next(row for row in rows if row["kind"] == "letters" and row["subject"] == "M")
    assert float(letter["estimate"]) == pytest.approx(33.1 / 118.6)


@pytest.mark.parametrize(
    ("p", "text"), [(0.0004, "<0.001"), (0.0123, "0.012"), (0.5, "0.50"), (None, "–"), (math.nan, "–")]
)
def test_p_is_written_with_digits_that_say_something(p, text):
    assert written_p(p) == text
