"""What the documentation shows runs, and names nothing that does not exist."""

import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

import sag.metrics
from sag.data.command import main as data
from sag.data.folder import FolderDataModule
from sag.errors import SagError
from sag.models.erd import MotionEncoders
from sag.report.command_line import main as report
from sag.types import Batch

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
METRICS = (ROOT / "docs/metrics.md").read_text()
OWN_DATA = (ROOT / "docs/own-data.md").read_text()
SMALL = ["--image_size=[36,64]"]


def blocks(page: str, language: str) -> list[str]:
    """What a page shows in a language."""
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)


@pytest.fixture
def own_data(tmp_path, monkeypatch) -> Path:
    """The folder that the skeleton and the script of the guide make, in an empty working folder."""
    monkeypatch.chdir(tmp_path)
    Path("mine").mkdir()
    Path("mine/skeleton.yaml").write_text(blocks(OWN_DATA, "yaml")[0])
    exec(blocks(OWN_DATA, "python")[0], {})
    return Path("mine")


def test_the_ten_lines_score_a_file(toy, tmp_path, monkeypatch, capsys):
    MotionEncoders("gta_im_19", width=0.01).save(toy.encoder_path, toy.cache.fingerprint)
    np.savez(tmp_path / "theirs.npz", joints=toy.cache.joints[toy.cache.rows("test")])
    monkeypatch.chdir(tmp_path)
    (block,) = blocks(METRICS, "python")
    assert len(block.partition("\n\n")[2].splitlines()) == 10
    exec(block.replace("RoomsDataModule()", "toy"), {"toy": toy})
    assert "'average': tensor(" in capsys.readouterr().out
    toy.encoder_path.unlink()


def test_every_public_metric_has_a_line_in_the_documentation():
    missing = [name for name in sag.metrics.__all__ if name[0].isupper() and f"`{name}" not in METRICS]
    assert missing == ["Gaussian"]


def test_the_guides_recordings_pass_its_check_and_are_prepared(own_data, capsys):
    assert len(blocks(OWN_DATA, "python")[0].replace("\n\n", "\n").splitlines()) <= 26
    assert data(["check", "mine", *SMALL, "--sheet", "sheet.png"]) == 0
    said = capsys.readouterr().out
    assert "nothing is broken" in said and "6 train, 6 val, 6 test" in said and "h36m_17: 17 joints" in said
    assert re.search("joints are 5 cm behind", said) and Path("sheet.png").is_file()
    assert data(["prepare", "mine", *SMALL]) == 0
    assert f"--data.init_args.skeleton={own_data.resolve()}/skeleton.yaml" in capsys.readouterr().out


def test_the_guides_data_module_reads_its_format(own_data):
    shown: dict[str, Any] = {"__name__": "walks"}
    exec(blocks(OWN_DATA, "python")[1], shown)
    for room in ("kitchen", "study"):
        old, new = own_data / f"{room}_1", own_data / f"{room}_2"
        new.mkdir()
        for name in ("", "_depth", "_person"):
            shutil.copy(old / f"00000{name}.png", new / f"{name[1:] or 'colour'}.png")
        joints = np.load(old / "motion.npz")["joints"] @ shown["WORLD2CAM"][:3, :3].T + shown["WORLD2CAM"][:3, 3]
        np.savetxt(new / "poses.csv", joints.reshape(-1, 51), delimiter=",")
    ours, theirs = (
        kind(own_data, skeleton="mine/skeleton.yaml", image_size=(36, 64))
        for kind in (FolderDataModule, shown["WalksDataModule"])
    )
    theirs.setup()
    assert theirs.describe()["windows"] == {"train": 1, "val": 1, "test": 1}
    first, same = (next(iter(module.test_dataloader()))[:1] for module in (ours, theirs))
    for read, wanted in zip(fields(same), fields(first)):
        assert torch.allclose(read.float(), wanted.float(), atol=1e-6)
    (own_data / "study_2/poses.csv").write_text("1,2,3\n")
    with pytest.raises(SagError, match=r"study_2/poses\.csv has no lines of 51 numbers"):
        theirs.plan()


def fields(batch: Batch) -> list[torch.Tensor]:
    """What two readers of the same window must agree on."""
    scene, cloud = batch.scene, batch.cloud
    seen = [scene.image, scene.depth, scene.person, scene.intrinsics, cloud.depth, cloud.intrinsics]
    return [batch.motion.joints, batch.world2cam, *seen]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_name_files_that_are_there(page):
    linked = re.findall(r"\]\((?!http)([^)#]+)\)", page.read_text())
    shown = re.findall(r"(?:configs|sweeps)/[\w/]+\.yaml", page.read_text())
    missing = [name for name in linked if not (page.parent / name).exists()]
    missing += [name for name in shown if not (ROOT / name).exists()]
    assert not missing


@pytest.mark.parametrize("page", [page for page in PAGES if "<!-- table of" in page.read_text()], ids=lambda p: p.name)
def test_tables_of_pages_are_those_of_the_kept_results(page, tmp_path, monkeypatch, capsys):
    copy = tmp_path / page.name
    shutil.copy(page, copy)
    monkeypatch.chdir(ROOT)
    assert report(["--page", str(copy)]) == 0
    assert copy.read_text() == page.read_text(), f"{page.name}: run `make pages`"
