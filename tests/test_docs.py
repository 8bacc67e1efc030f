"""What the documentation shows runs, and names nothing that does not exist."""

import re
from pathlib import Path

import numpy as np
import pytest

import sag.metrics
from sag.models.erd import MotionEncoders

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
METRICS = (ROOT / "docs/metrics.md").read_text()


def test_the_ten_lines_score_a_file(toy, tmp_path, monkeypatch, capsys):
    MotionEncoders("gta_im_19", width=0.01).save(toy.encoder_path, toy.cache.fingerprint)
    np.savez(tmp_path / "theirs.npz", joints=toy.cache.joints[toy.cache.rows("test")])
    monkeypatch.chdir(tmp_path)
    (block,) = re.findall(r"```python\n(.*?)```", METRICS, re.DOTALL)
    assert len(block.partition("\n\n")[2].splitlines()) == 10
    exec(block.replace("RoomsDataModule()", "toy"), {"toy": toy})
    assert "'average': tensor(" in capsys.readouterr().out
    toy.encoder_path.unlink()


def test_every_public_metric_has_a_line_in_the_documentation():
    missing = [name for name in sag.metrics.__all__ if name[0].isupper() and f"`{name}" not in METRICS]
    assert missing == ["Gaussian"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_name_files_that_are_there(page):
    linked = re.findall(r"\]\((?!http)([^)#]+)\)", page.read_text())
    shown = re.findall(r"(?:configs|sweeps)/[\w/]+\.yaml", page.read_text())
    missing = [name for name in linked if not (page.parent / name).exists()]
    missing += [name for name in shown if not (ROOT / name).exists()]
    assert not missing
