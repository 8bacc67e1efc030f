"""Whole reports of made-up runs, file by file."""

import csv
import io
import math
import re
from html.parser import HTMLParser

import pytest
from PIL import Image

from sag.errors import SagError
from sag.report import main

FILES = {
    "table.md", "table.csv", "table.tex", "table.html", "plot.png", "plot.svg", "statistics.csv", "letters.png",
    "letters.svg",
}  # fmt: skip


def report(runs, name="table.md"):
    assert main([str(runs.folder)]) == 0
    return (runs.folder / name).read_text(encoding="utf-8")


def markdown_rows(text):
    """Cells of every row of the first table by its first cell."""
    lines = [line.strip("| ").split("|") for line in text.partition("\n## ")[0].splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line] for line in lines]
    return {row[0]: row for row in (c + [""] * (len(cells[0]) - len(c)) for c in cells)}


def csv_rows(runs):
    return {row["row"]: row for row in csv.DictReader(io.StringIO(report(runs, "table.csv")))}


def test_the_table_has_every_row_ours_beside_the_papers(whole):
    text = report(whole)
    rows = markdown_rows(text)
    headings = rows["row"]
    assert headings == [
        "row", "M", "D", "P", "C",
        "FID short", "FID mid", "FID long", "FID average", "FID paper",
        "NC 30 mm", "NC 45 mm", "NC 60 mm", "NC average", "NC paper", "steps", "min",
    ]  # fmt: skip
    assert len(rows) == 1 + 1 + 16 + 2
    assert rows["mdc"][1:5] == ["✓", "✓", "", "✓"]
    mdc = dict(zip(headings, rows["mdc"]))
    assert mdc["FID average"] == "17.2" and mdc["FID paper"] == "30.8"
    assert mdc["NC average"] == "0.905" and mdc["NC paper"] == "0.923"
    assert mdc["steps"] == "700" and mdc["min"] == "2.8"
    assert dict(zip(headings, rows["mp"]))["FID paper"] == ""
    floor = dict(zip(headings, rows["floor: real against real, halves"]))
    assert floor["FID average"] == "0.700" and floor["NC average"] == ""
    assert "**16.2**" in rows["mdpc"], "the best is bold"
    assert "Warning" not in text


def test_what_must_be_known_stands_below(whole):
    text = report(whole)
    for fact in (
        "rooms (fingerprint abcdef123456), 30 fps", "1,100 motions", "10,000 frames", "140,000 scene points",
        "e5c0de", "gta_im_19", "Seeds: 0", "torch 2.13.0", "commit b33a343", f"smallest {100 / 19.75:.2f}",
    ):  # fmt: skip
        assert fact in text
    ratios = next(line for line in text.splitlines() if line.startswith("- Motion FID without M"))
    assert ratios.count(" / ") == 8, "eight pairs of twins"


def test_failed_rows_and_nan_are_loud(runs):
    runs.add("none", math.nan)
    runs.add("m", 20.0)
    runs.fail("mdp")
    runs.fail("md", "waiting", None)
    text = report(runs)
    rows = markdown_rows(text)
    assert rows["none"][8] == "**NaN**" and rows["mdp"][8] == "**failed**" and rows["md"][8] == "**waiting**"
    assert rows["mdp"][1:5] == ["✓", "✓", "✓", ""]
    assert "**Warning:** NaN in none: motion_fid/short" in text
    assert "**Warning:** mdp failed: exit status 1: ValueError: no depth." in text
    assert "**Warning:** md has not run" in text
    assert "none / m NaN; smallest NaN" in text
    assert "**20.0**" in rows["m"], "NaN is never the best"


def test_nan_is_never_the_smallest_ratio(runs):
    for row, fid in {"none": math.nan, "m": 20.0, "d": 60.0, "md": 20.0}.items():
        runs.add(row, fid)
    assert "none / m NaN, d / md 3.00; smallest 3.00" in report(runs)


def test_few_motions_and_the_datas_own_notes_are_warned_of(runs):
    runs.add(
        "m", data={"notes": ["train and test are the same windows: figures mean nothing"]}, protocol={"motions": 21}
    )
    text = report(runs)
    assert "**Warning:** N = 21 is far too small for these figures to mean anything." in text
    assert "**Warning:** train and test are the same windows: figures mean nothing." in text
    assert "far too small" in report(runs, "table.html") and "far too small" in report(runs, "table.tex")


def test_who_was_pretrained_is_said(runs):
    runs.add("md", data={"name": "prox"})
    runs.add("mdpc", data={"name": "prox"})
    runs.add_truth(data={"name": "prox"})
    assert "No row was pre-trained; the paper's rows on PROX were" in report(runs)
    runs.add("md", data={"name": "prox"}, pretrained="before/md/checkpoints/last.ckpt")
    text = report(runs)
    assert "Only md started in checkpoints of other data" in text
    assert "training started in before/md/checkpoints/last.ckpt" in text
    runs.add("mdpc", data={"name": "prox"}, pretrained="before/mdpc/checkpoints/last.ckpt")
    assert "pre-trained;" not in report(runs)
    assert "Only" not in report(runs)


def test_seeds_are_mean_interval_and_n(runs):
    for seed, fid in enumerate((10.0, 14.0, 18.0)):
        runs.add(f"m-s{seed}", fid, seed=seed)
    text = report(runs)
    rows = markdown_rows(text)
    cells = dict(zip(rows["row"], rows["m"]))
    half = 4.302653 * 4 / math.sqrt(3)
    assert cells["FID average"] == f"**14.0 ± {half:.1f}**" and cells["n"] == "3"
    assert "Seeds: 0, 1, 2; figures are mean ± half of the 95 % t-interval over n = 3 runs" in text
    row = csv_rows(runs)["m"]
    assert float(row["motion_fid/average/deviation"]) == 4.0
    assert float(row["motion_fid/average/half"]) == pytest.approx(half, rel=1e-6)


def test_one_seed_has_no_interval(runs):
    runs.add("m", 10.0)
    assert markdown_rows(report(runs))["m"][8] == "**10.0**"
    row = csv_rows(runs)["m"]
    assert row["motion_fid/average/deviation"] == row["motion_fid/average/half"] == ""


def test_unequal_seeds_and_commits_are_said(runs):
    for row in ("none", "m"):
        for seed in (0, 1):
            runs.add(f"{row}-s{seed}", seed=seed)
    assert "Warning" not in report(runs)
    runs.add("m-s2", seed=2, commit="0ther00")
    text = report(runs)
    assert "**Warning:** Rows have unequal seeds: 0, 1 in none; 0, 1, 2 in m." in text
    assert "**Warning:** Rows come from different commits: b33a343 in none-s0 and 3 others; 0ther00 in m-s2." in text


def test_csv_keeps_every_digit(whole):
    whole.add("m", 1 / 3)
    whole.fail("mdp")
    rows = csv_rows(whole)
    assert list(rows) == [*list(rows)[:16], "ground_truth"]
    assert float(rows["m"]["motion_fid/average"]) == 1 / 3
    assert [rows["m"][letter] for letter in "MDPC"] == ["1", "0", "0", "0"]
    assert [float(rows["none"][f"paper/motion_fid/{n}"]) for n in ("short", "mid", "long")] == [92.4, 125.6, 137.8]
    assert rows["none"]["paper/non_collision/30"] == ""
    assert (rows["mdp"]["state"], rows["mdp"]["motion_fid/average"]) == ("failed", "")
    assert "no depth" in rows["mdp"]["reason"]
    assert float(rows["ground_truth"]["motion_fid_floor/average"]) == 0.7
    assert rows["ground_truth"]["M"] == ""


def test_nan_in_csv_reads_back_as_nan(runs):
    runs.add("m", math.nan)
    assert math.isnan(float(csv_rows(runs)["m"]["motion_fid/average"]))


def test_latex_is_whole(whole):
    whole.fail("mdp", reason="100 % of ~ {x} failed_\\ & $ # ^ <y>")
    text = report(whole, "table.tex")
    bare = re.sub(r"\\.", "", text)
    assert bare.count("{") == bare.count("}")
    assert re.findall(r"\\begin\{(\w+\*?)\}", text) == re.findall(r"\\end\{(\w+\*?)\}", text)[::-1]
    first = text.partition(r"\end{table*}")[0]
    (alignment,) = re.findall(r"\\begin\{tabular\}\{([lcr]+)\}", first)
    body = [line for line in first.splitlines() if line.endswith(r"\\")]
    spans = [sum(int(n) - 1 for n in re.findall(r"\\multicolumn\{(\d+)\}", line)) for line in body]
    counts = {len(re.findall(r"(?<!\\)&", line)) + 1 + span for line, span in zip(body, spans)}
    assert counts == {len(alignment)}
    assert text.isascii(), "every sign has its command"
    assert r"\toprule" in text and r"\midrule" in text and r"\bottomrule" in text
    assert r"100 \% of \textasciitilde{} \{x\} failed\_" in text


class Balance(HTMLParser):
    """Finds tags that are not closed and addresses of other files."""

    def __init__(self):
        super().__init__()
        self.open, self.wrong, self.addresses = [], [], []

    def handle_starttag(self, tag, attrs):
        self.addresses += [v for k, v in attrs if k in ("src", "href") and not v.startswith("#")]
        if tag not in ("meta", "br", "img", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)


def test_html_is_whole_and_needs_nothing_else(whole):
    whole.fail("mdp", reason="<script>alert(1)</script>")
    text = report(whole, "table.html")
    parser = Balance()
    parser.feed(re.sub(r"<(\w+)([^<>]*)/>", r"<\1\2></\1>", text))
    assert (parser.open, parser.wrong, parser.addresses) == ([], [], [])
    assert "prefers-color-scheme: dark" in text
    assert "<script>" not in text and "&lt;script&gt;" in text
    assert "currentColor" in text and "<svg" in text
    assert "125.6" in text, "all of the paper's cells"
    rows = re.findall(r"<tr><td.*?</tr>", text.partition("</table>")[0])
    assert len(rows) == 18 and len({row.count("<td") for row in rows}) == 1


def test_the_plot_names_every_row(whole):
    whole.fail("mdp")
    whole.add("none", math.nan)
    text = report(whole, "plot.svg")
    for name in ("MDPC", "DPC", "none", "failed", "NaN", "printed in the paper", "floor", "ground truth"):
        assert name in text
    with Image.open(whole.folder / "plot.png") as picture:
        assert picture.width > 1200 and len(picture.convert("RGB").getcolors(1 << 20)) > 50


def test_the_same_rows_make_the_same_files(whole):
    written = []
    for _ in range(2):
        report(whole)
        written.append({name: (whole.folder / name).read_bytes() for name in FILES})
    assert written[0] == written[1]


def test_it_says_where_its_files_are_and_shows_the_table(whole, tmp_path, capsys):
    assert main([str(whole.folder), "--out", str(tmp_path / "elsewhere")]) == 0
    assert {path.name for path in (tmp_path / "elsewhere").iterdir()} == FILES
    said = capsys.readouterr().out
    assert str(tmp_path / "elsewhere") in said
    assert "mdpc" in said and "…" not in said
    assert not (whole.folder / "table.md").exists()


def test_rows_of_several_kinds_leave_no_table(runs):
    runs.add("none")
    runs.add("m", protocol={"motions": 21})
    with pytest.raises(SagError, match="N of motions"):
        main([str(runs.folder)])
    assert not (runs.folder / "table.md").exists()
