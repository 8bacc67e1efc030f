"""Results that stay: small files without a machine's paths, from which the same report comes."""

import json

import pytest
import yaml

from sag.errors import SagError
from sag.report import main
from sag.report.portable import ELSEWHERE, portable, portable_command


@pytest.fixture
def trained(runs, tmp_path, monkeypatch):
    """Two rows of two seeds with all that a run leaves, one of them failed."""
    monkeypatch.chdir(tmp_path)
    for row, fid in {"none": 100.0, "m": 20.0}.items():
        for seed in range(2):
            runs.add(f"{row}-s{seed}", fid + seed, seed=seed, pretrained=f"{tmp_path}/before/last.ckpt")
    for run in runs.folder.iterdir():
        config = {"trainer": {"default_root_dir": str(run)}, "data": {"root": "/home/somebody/prox"}}
        (run / "config.fit.yaml").write_text(yaml.safe_dump(config))
        command = ["/usr/bin/env", f"{tmp_path}/.venv/bin/python", "-m", "sag", "run", f"--config={tmp_path}/a.yaml"]
        runs.write(run.name, "status.json", {"state": "finished", "pid": 7, "command": command, "command_hash": "ab"})
        (run / "checkpoints").mkdir()
        (run / "checkpoints" / "last.ckpt").write_bytes(b"large")
        (run / "log.txt").write_text("long")
    runs.fail("md-s0", reason=f"exit status 1: no file {tmp_path}/x and /home/somebody/y.npz")
    return runs


def kept(trained, tmp_path, *options):
    assert main([str(trained.folder), "--keep", "results/table1", *options]) == 0
    return tmp_path / "results" / "table1"


def tables(folder):
    return {name: (folder / name).read_text() for name in ("table.csv", "statistics.csv")}


def test_small_files_are_kept_and_nothing_else(trained, tmp_path):
    folder = kept(trained, tmp_path)
    assert {path.name for path in (folder / "m-s1").iterdir()} == {"metrics.json", "config.fit.yaml", "status.json"}
    assert {path.name for path in (folder / "md-s0").iterdir()} == {"status.json"}
    assert {path.name for path in folder.iterdir() if path.is_file()} >= {"table.md", "plot.png", "statistics.csv"}
    assert [path.name for path in folder.parent.iterdir()] == ["table1"], "nothing half written"
    assert (trained.folder / "m-s1" / "checkpoints" / "last.ckpt").is_file()


def test_the_same_report_comes_from_them_alone(trained, tmp_path):
    folder = kept(trained, tmp_path)
    assert tables(folder) == {name: t.replace(f"{tmp_path}/x", "x").replace("/home/somebody/", f"{ELSEWHERE}/")
                              for name, t in tables(trained.folder).items()}  # fmt: skip
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    assert main([str(folder)]) == 0
    assert before == {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    assert "md-s0 failed" in (folder / "table.md").read_text()


def test_no_absolute_path_is_kept(trained, tmp_path):
    folder = kept(trained, tmp_path)
    texts = [
        path.read_text() for path in folder.rglob("*") if path.suffix in (".json", ".yaml", ".md", ".csv", ".html")
    ]
    assert not any(str(tmp_path) in text or "somebody" in text for text in texts)
    status = json.loads((folder / "m-s0" / "status.json").read_text())
    assert status["command"] == ["env", "python", "-m", "sag", "run", "--config=a.yaml"]
    assert "pid" not in status and status["command_hash"] == "ab"
    assert json.loads((folder / "m-s0" / "metrics.json").read_text())["pretrained"] == "before/last.ckpt"
    config = yaml.safe_load((folder / "m-s0" / "config.fit.yaml").read_text())
    assert config == {"trainer": {"default_root_dir": "ablation/m-s0"}, "data": {"root": f"{ELSEWHERE}/prox"}}


def test_what_is_there_is_replaced_only_when_asked(trained, tmp_path):
    folder = kept(trained, tmp_path)
    (trained.folder / "none-s1" / "metrics.json").unlink()
    with pytest.raises(SagError, match="--overwrite"):
        kept(trained, tmp_path)
    assert (folder / "none-s1" / "metrics.json").is_file()
    kept(trained, tmp_path, "--overwrite")
    assert not (folder / "none-s1" / "metrics.json").exists()


@pytest.mark.parametrize("foreign", ["notes.txt", "m-s0/checkpoints/last.ckpt", "m-s0/log.txt"])
def test_what_is_no_kept_result_is_never_replaced(trained, tmp_path, foreign):
    path = kept(trained, tmp_path) / foreign
    path.parent.mkdir(exist_ok=True)
    path.write_text("mine")
    with pytest.raises(SagError, match="no kept result"):
        kept(trained, tmp_path, "--overwrite")
    assert path.read_text() == "mine"


@pytest.mark.parametrize("place", ["ablation", "ablation/kept", "."])
def test_results_are_not_kept_in_their_own_sweep(trained, place):
    with pytest.raises(SagError, match="lie in each other"):
        main([str(trained.folder), "--keep", place, "--overwrite"])


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("/home/me/project/runs/a", "runs/a"), ("/home/me/project", "."), ("/home/me/projects/x", "<elsewhere>/x"),
        ("--data.root=/data/prox", "--data.root=<elsewhere>/prox"),
        ("no '/x/y.npz'; mend", "no '<elsewhere>/y.npz'; mend"),
        ("runs/a/b", "runs/a/b"), ("in m/s", "in m/s"), ("https://w.org/x", "https://w.org/x"), ("a / b", "a / b"),
    ],
)  # fmt: skip
def test_paths_become_portable(text, wanted, tmp_path):
    from pathlib import Path

    assert portable({"x": [text, 3, None]}, Path("/home/me/project")) == {"x": [wanted, 3, None]}


def test_programs_are_called_by_their_names(tmp_path):
    assert portable_command(["/usr/bin/env", "python3", "-m"], tmp_path) == ["env", "python3", "-m"]
