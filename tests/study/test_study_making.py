"""`sag study make`: motions of runs become a study, and what cannot is refused by name."""

import json

import numpy as np
import pytest
from toy_runs import toy_sweep

from sag.cli import main
from sag.study.folder import TRUTH, read_study
from sag.study.sessions import all_scenes


@pytest.fixture
def sweep(tmp_path, toy):
    """A sweep with the paper's rows and one more."""
    return toy_sweep(tmp_path / "sweep", toy, ("none", "md", "mdpc", "mp"))


def test_a_sweep_stands_for_the_papers_rows(sweep, toy, tmp_path, capsys):
    out = tmp_path / "study"
    assert main(["study", "make", str(sweep), "--windows", "2", "--out", str(out)]) == 0
    study = read_study(out)
    assert study.settings.methods == ("none", "md", "mdpc", TRUTH)
    assert study.settings.data == "toy" and study.settings.fingerprint == toy.cache.fingerprint
    assert study.design.turns == 2 * 4 + 2 and len(json.loads(all_scenes(study))) == 2
    said = capsys.readouterr().out
    assert "2 scenes of toy, each with none, md, mdpc, ground_truth" in said and "10 motions for each rater" in said
    assert set(study.settings.windows) <= set(toy.cache.rows("test").tolist())


def test_any_runs_and_files_may_be_mixed(sweep, toy, tmp_path):
    rows = toy.cache.rows("test")
    np.savez(tmp_path / "theirs.npz", joints=toy.cache.joints[rows], index=rows, fps=30.0)
    sources = [str(sweep / "mp"), str(tmp_path / "theirs.npz")]
    assert main(["study", "make", *sources, "--windows", "1", "--rounds", "2", "--out", str(tmp_path / "s")]) == 0
    study = read_study(tmp_path / "s")
    assert study.settings.methods == ("mp", "theirs", TRUTH) and study.design.turns == 2
    # Their file holds the recorded motions: those two motions are the same, the run's is another.
    (scene,) = json.loads(all_scenes(study)).values()
    of = {study.settings.methods[study.items[name].method]: motion["joints"]["places"]
          for name, motion in zip(scene["motions"], scene["rows"][0]["motions"])}  # fmt: skip
    assert of["theirs"] == of[TRUTH] != of["mp"]


REFUSALS = {
    "windows": (["RUN", "--windows", "99"], "--windows is 99, and there are 4 test windows"),
    "rounds": (["RUN", "--windows", "1", "--rounds", "3"], "--rounds is 3; a scene can come 1 to 2 times"),
    "repeats": (["RUN", "--windows", "2", "--repeats", "2"], "--repeats is 2; of 4 motions 0 to 1"),
    "missing": (["nowhere"], "nowhere does not exist"),
    "no row": (["PART"], "has no trained row md"),
    "untrained": (["RUN", "UNTRAINED"], "untrained/none/checkpoints/last.ckpt is of a SAG that was not trained"),
    "no checkpoint": (["RUN", "GONE"], "gone/md"),
    "truth": (["TRUTH"], "ground_truth is in every study by itself"),
    "note": (["RUN", "--note", "nothing.txt"], "--note nothing.txt cannot be read"),
    "twice": (["RUN", "RUN"], "two of the runs are called 'mp'"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSALS)
def test_refuses(name, sweep, toy, tmp_path, capsys):
    part = toy_sweep(tmp_path / "part", toy, ("none", "mdpc"))
    known = {
        "RUN": sweep / "mp", "PART": part, "TRUTH": toy_sweep(tmp_path / "t", toy, (TRUTH,)) / TRUTH,
        "UNTRAINED": toy_sweep(tmp_path / "untrained", toy, ("none",), trained=False) / "none",
        "GONE": toy_sweep(tmp_path / "gone", toy, ("md",)) / "md",
    }  # fmt: skip
    (tmp_path / "gone/md/checkpoints/last.ckpt").unlink()
    options, said = REFUSALS[name]
    asked = [str(known.get(option, option)) for option in options]
    assert main(["study", "make", *asked, "--out", str(tmp_path / "study")]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not (tmp_path / "study").exists()


def test_a_study_is_not_made_over_another(study, sweep, capsys):
    assert main(["study", "make", str(sweep), "--windows", "1", "--out", str(study.folder)]) == 2
    assert "holds a study already" in capsys.readouterr().err
