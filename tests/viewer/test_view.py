"""`sag view`: pages of runs, sweeps and files, and what it refuses."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import torch

from sag.cli import main
from sag.data.base import Windows
from sag.metrics import collision_counts
from sag.viewer import shown_window
from sag.viewer.figures import COLUMNS, TOUCH


def content(path: Path) -> dict:
    return json.loads(re.search(r'type="application/json">(.*?)</script>', path.read_text(), re.DOTALL).group(1))


def shapes(told: dict) -> list:
    """Name and samples of each row of each window."""
    return [[(row["name"], len(row["motions"])) for row in window["rows"]] for window in told["windows"]]


def test_a_run_is_sampled(sweep, toy, capsys):
    assert main(["view", str(sweep / "mdpc"), "--samples", "3"]) == 0
    said = capsys.readouterr().out
    assert f"the page is in {sweep / 'mdpc/view.html'}" in said
    told = content(sweep / "mdpc/view.html")
    assert shapes(told) == [[("mdpc", 3)]]
    first, second, _ = (motion["joints"]["places"] for motion in told["windows"][0]["rows"][0]["motions"])
    assert first != second
    known = {column.key for column in COLUMNS} - {"penetration"}
    assert set(told["windows"][0]["rows"][0]["motions"][0]["figures"]) == known


def test_a_sweep_has_rows_and_one_seed_gives_one_page(sweep, tmp_path):
    texts = []
    for name, seed in (("first", "0"), ("again", "0"), ("other", "1")):
        out = tmp_path / f"{name}.html"
        assert main(["view", str(sweep), "--samples", "2", "--windows", "2", "--seed", seed, "--out", str(out)]) == 0
        texts.append(out.read_text())
    assert shapes(content(out)) == [[("mdpc", 2), ("none", 2)]] * 2
    assert texts[0] == texts[1] != texts[2]


def test_a_window_is_the_same_whatever_else_is_shown(sweep, toy, tmp_path):
    places = toy.cache.rows("test").tolist()
    pages = []
    for name, chosen in (("alone", places[1:2]), ("both", places[:2])):
        out = tmp_path / f"{name}.html"
        options = ["--window", *map(str, chosen), "--samples", "2", "--out", str(out)]
        assert main(["view", str(sweep / "none"), *options]) == 0
        pages.append(content(out)["windows"][-1])
    assert pages[0] == pages[1]
    assert pages[0]["name"] == f"toy {places[1]}"


def predictions(path: Path, toy, samples: int = 4, **changes) -> Path:
    """The recorded motions as a file, with so many samples a window."""
    rows = toy.cache.rows("test")
    joints = np.repeat(toy.cache.joints[rows][:, None], samples, axis=1)
    np.savez(path, **{"joints": joints, "index": rows, "fps": 30.0, **changes})
    return path


def test_a_file_stands_beside_a_run(sweep, toy, tmp_path):
    file = predictions(tmp_path / "theirs.npz", toy)
    out = tmp_path / "page.html"
    assert main(["view", str(sweep / "none"), str(file), "--samples", "3", "--out", str(out)]) == 0
    told = content(out)
    assert shapes(told) == [[("none", 3), ("theirs", 3)]]
    assert told["windows"][0]["rows"][1]["motions"][0]["figures"]["off"] < 1e-6
    assert told["windows"][0]["rows"][0]["motions"][0]["figures"]["off"] > 1e-3


def test_a_file_finds_the_config_beside_it(sweep, toy):
    file = predictions(sweep / "none/predictions.npz", toy)
    assert main(["view", str(file)]) == 0
    assert shapes(content(sweep / "none/predictions.html")) == [[("none", 4)]]


def test_a_file_of_a_few_windows_shows_those(sweep, toy, tmp_path):
    last = int(toy.cache.rows("test")[-1])
    joints = toy.cache.joints[[last]]
    file = tmp_path / "one.npz"
    np.savez(file, joints=joints, index=np.array([last]))
    assert main(["view", str(file), "--reference", str(sweep / "none/config.fit.yaml")]) == 0
    assert content(tmp_path / "one.html")["windows"][0]["name"] == f"toy {last}"


def test_a_shown_window_counts_as_the_metric_does(toy):
    batch = Windows(toy.cache, "test", toy.skeleton, with_cloud=True)[1]
    joints = batch.motion.joints + torch.tensor([0.0, 0.0, 1.0])
    shown = shown_window(toy, batch, {"moved": joints})
    bones = torch.as_tensor(toy.skeleton.bone_index)
    counts = collision_counts(joints[0], bones, batch.cloud.depth[0], batch.cloud.intrinsics[0], (TOUCH,))
    assert shown.rows[0].motions[0].touched.tolist() == counts[:, 0].tolist()
    assert shown.rows[0].motions[0].figures["off"] == pytest.approx(1.0, abs=1e-5)
    assert shown.up == (0.0, -1.0, 0.0)
    ankles = batch.motion.joints[0, 0, toy.skeleton.feet, 1].max()
    assert shown.floor == pytest.approx(-float(ankles) - toy.ankle_height, abs=1e-5)
    assert (shown.scene.depth[shown.scene.hidden] == 0).all() and shown.scene.hidden.any()


REFUSALS = {
    "samples": (["RUN", "--samples", "10"], "--samples is 10; a page tells 1 to 9"),
    "no samples": (["RUN", "--samples", "0"], "--samples is 0"),
    "windows": (["RUN", "--windows", "99"], "--windows is 99, and there are 4 test windows"),
    "window": (["RUN", "--window", "0"], "--window 0 is no test window of toy that these sources have; the nearest"),
    "out": (["RUN", "--out", "page.txt"], "--out page.txt must be a file that ends in .html"),
    "missing": (["nowhere"], "nowhere does not exist"),
    "no run": (["EMPTY"], "holds neither a run"),
    "no reference": (["FILE"], "does not tell its data set; name it with --reference"),
    "reference": (["FILE", "--reference", "rooom"], "--reference rooom is neither a file nor one of"),
    "twice": (["RUN", "RUN"], "two of the runs are called 'mdpc'"),
    "not a number": (["NAN", "--reference", "CONFIG"], "motion 1 has coordinates that are not finite"),
    "joints": (["FEW", "--reference", "CONFIG"], "has 16 joints, not the 19"),
    "no npz": (["TEXT", "--reference", "CONFIG"], "cannot be read as a .npz"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSALS)
def test_refuses(name, sweep, toy, tmp_path, capsys):
    broken = np.array(toy.cache.joints[toy.cache.rows("test")])
    few = broken[:, :, :16].copy()
    broken[1, 5, 3, 2] = np.nan
    (tmp_path / "empty").mkdir()
    (tmp_path / "text.npz").write_text("no archive")
    known = {
        "RUN": sweep / "mdpc", "EMPTY": tmp_path / "empty", "CONFIG": sweep / "mdpc/config.fit.yaml",
        "FILE": predictions(tmp_path / "fine.npz", toy), "NAN": predictions(tmp_path / "nan.npz", toy, joints=broken),
        "FEW": predictions(tmp_path / "few.npz", toy, joints=few), "TEXT": tmp_path / "text.npz",
    }  # fmt: skip
    options, said = REFUSALS[name]
    assert main(["view", *(str(known.get(option, option)) for option in options)]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not list(tmp_path.rglob("*.html"))
