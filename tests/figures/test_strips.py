"""`sag figure`: strips of runs and contact sheets, which reports embed."""

import base64
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from toy_runs import toy_run

from sag.cli import main
from sag.figures.command_line import _letters
from sag.report.html import html
from sag.report.table import Report, Table
from sag.runs import read_runs


@pytest.fixture
def sweep(tmp_path: Path, toy) -> Path:
    """A folder of two runs, of which the first in the alphabet has more letters."""
    toy_run(tmp_path / "sweep/a", toy, depth=True)
    toy_run(tmp_path / "sweep/b", toy)
    return tmp_path / "sweep"


@pytest.mark.parametrize("name", ["strips.png", "strips.svg", "strips.pdf"])
def test_scenes_over_runs(name, sweep, tmp_path, capsys):
    out = tmp_path / name
    assert main(["figure", "strips", str(sweep), "--windows", "2", "--poses", "3", "--out", str(out)]) == 0
    assert "2 scenes, b, a:" in capsys.readouterr().out  # fewer letters first
    starts = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    assert out.read_bytes().startswith(starts[out.suffix])


def test_rows_stand_in_the_order_of_their_letters(sweep):
    assert [run.name for run in sorted(read_runs([sweep]), key=_letters)] == ["b", "a"]


def test_motions_of_one_run_side_by_side_or_together(sweep, tmp_path, toy, capsys):
    window, out = str(toy.cache.rows("test")[1]), tmp_path / "strips.png"
    options = ["figure", "strips", str(sweep / "a"), "--window", window, "--poses", "2", "--out", str(out)]
    assert main(options) == 0
    assert "1 scene, a 1, a 2, a 3" in capsys.readouterr().out
    wide = Image.open(out).size
    assert main([*options, "--together"]) == 0
    assert Image.open(out).size[0] < wide[0] / 2


def test_sheets_lie_with_their_runs(sweep, capsys):
    assert main(["figure", "sheets", str(sweep)]) == 0
    found = [np.asarray(Image.open(sweep / name / "samples.png").convert("RGB")) for name in ("a", "b")]
    assert found[0].shape == (135, 4 * 244 - 4, 3) and not np.array_equal(*found)


def test_reports_embed_sheets(sweep):
    main(["figure", "sheets", str(sweep / "a")])
    content = (sweep / "a/samples.png").read_bytes()
    report = Report("title", (Table("", (), (), ""),), (), ())
    text = html(report, "", (), [("<a>", content)])
    assert base64.b64encode(content).decode() in text and "samples of &lt;a&gt;" in text
    assert "Samples" not in html(report, "")


REFUSALS = {
    "format": (["--out", "strips.jpg"], "--out strips.jpg must be a file that ends in .png, .svg, .pdf"),
    "poses": (["--poses", "1"], "--poses must be at least 2"),
    "window": (["--window", "0"], "--window 0 is no test window of toy"),
    "windows": (["--windows", "99"], "--windows is 99"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_refuses(name, sweep, tmp_path, monkeypatch, capsys):
    options, said = REFUSALS[name]
    monkeypatch.chdir(tmp_path)
    assert main(["figure", "strips", str(sweep), *options]) == 2
    assert said in capsys.readouterr().err and not Path("strips.png").exists()
