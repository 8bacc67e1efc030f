"""Whole sweeps of a fake program: what runs, what runs again, what is said."""

import json
import subprocess
import sys

import pytest

from sag.errors import SagError
from sag.sweep import main

ROWS = {"none", "c", "m", "mc", "blind"}
ALL = {"encoders", "ground_truth", *ROWS}


def test_every_row_runs_once_with_its_place_in_the_environment(workplace, capsys):
    assert main(["sweep.yaml", "--jobs", "2"]) == 0
    assert set(workplace.states().values()) == {"finished"}
    assert sorted(workplace.names()) == sorted(ALL)
    assert workplace.names()[0] == "encoders"
    call = next(call for call in workplace.calls() if call["row"] == "mc")
    assert call["arguments"][-1] == "--trainer.default_root_dir=runs/trial/mc"
    assert call["environment"]["WANDB_RUN_GROUP"] == "trial"
    assert call["environment"]["WANDB_NAME"] == "mc"
    assert call["environment"]["OMP_NUM_THREADS"] == call["environment"]["MKL_NUM_THREADS"]
    assert "hello from mc" in (workplace.out / "mc" / "log.txt").read_text()
    said = capsys.readouterr().out
    assert "all 7 runs finished" in said and "sag report runs/trial" in said


@pytest.mark.parametrize(("allowed", "wanted"), [(None, "2"), ("1", "1"), ("16", "2"), ("many", "2")])
def test_threads_share_the_cores_that_are_allowed(workplace, monkeypatch, allowed, wanted):
    monkeypatch.setattr("sag.sweep.process.cores", lambda: 8)
    monkeypatch.delenv("OMP_NUM_THREADS") if allowed is None else monkeypatch.setenv("OMP_NUM_THREADS", allowed)
    main(["sweep.yaml", "--jobs", "4"])
    threads = {call["row"]: call["environment"]["OMP_NUM_THREADS"] for call in workplace.calls()}
    assert set(threads.values()) == {wanted}


def test_finished_rows_are_not_run_again(workplace, capsys):
    main(["sweep.yaml"])
    workplace.forget()
    assert main(["sweep.yaml", "--out", str(workplace.out)]) == 0
    assert workplace.names() == []
    assert "7 finished before" in capsys.readouterr().out


def test_a_changed_config_runs_its_rows_again(workplace):
    main(["sweep.yaml"])
    workplace.forget()
    workplace.write("configs/methods/ground_truth.yaml", "changed: true")
    main(["sweep.yaml"])
    assert workplace.names() == ["ground_truth"]
    workplace.forget()
    workplace.write("configs/methods/erd.yaml", "changed: true")
    main(["sweep.yaml"])
    assert set(workplace.names()) == ALL, "other encoders, other figures"


def test_a_row_without_its_figures_is_run_again(workplace):
    main(["sweep.yaml"])
    workplace.forget()
    (workplace.out / "m" / "metrics.json").unlink()
    main(["sweep.yaml"])
    assert workplace.names() == ["m"]


def test_a_failed_row_does_not_stop_the_others_and_is_tried_again(workplace, capsys):
    workplace.wishes(c={"fails": "the scene is empty"})
    assert main(["sweep.yaml"]) == 1
    assert workplace.states() == {name: "failed" if name == "c" else "finished" for name in ALL}
    assert workplace.status("c")["reason"] == "exit status 1: ValueError: the scene is empty"
    said = capsys.readouterr().out
    assert "1 of 7 runs failed" in said and "ValueError: the scene is empty" in said
    assert "runs/trial/c/log.txt" in said
    workplace.wishes()
    workplace.forget()
    assert main(["sweep.yaml"]) == 0
    assert workplace.names() == ["c"]


def test_a_row_that_leaves_no_figures_has_failed(workplace):
    workplace.wishes(m={"silent": True})
    assert main(["sweep.yaml"]) == 1
    assert workplace.status("m")["reason"] == "it ended without writing metrics.json"


def test_a_new_try_starts_in_an_empty_folder(workplace):
    workplace.wishes(m={"fails": "half way"})
    main(["sweep.yaml"])
    assert (workplace.out / "m" / "begun").exists()
    (workplace.out / "m" / "old.ckpt").touch()
    workplace.wishes()
    main(["sweep.yaml"])
    assert not (workplace.out / "m" / "old.ckpt").exists()


def test_folders_that_no_sweep_wrote_are_not_touched(workplace):
    workplace.write("runs/trial/m/precious.ckpt", "")
    with pytest.raises(SagError, match="no sweep wrote"):
        main(["sweep.yaml"])
    assert (workplace.out / "m" / "precious.ckpt").exists()


def test_without_encoders_nothing_else_starts(workplace, capsys):
    workplace.wishes(encoders={"fails": "no data"})
    assert main(["sweep.yaml"]) == 1
    assert workplace.names() == ["encoders"]
    assert workplace.states() == {name: "failed" if name == "encoders" else "waiting" for name in ALL}
    assert "ValueError: no data" in capsys.readouterr().out


def test_jobs_bound_how_many_rows_run_at_a_time(workplace):
    workplace.wishes(**{name: {"seconds": 0.3} for name in ROWS})
    main(["sweep.yaml", "--jobs", "2"])
    spans = [(workplace.status(name)["started"], workplace.status(name)["ended"]) for name in ALL - {"encoders"}]
    together = [sum(start <= moment < end for start, end in spans) for moment, _ in spans]
    assert max(together) == 2


def test_seeds_and_extra_keys_reach_the_rows(workplace):
    workplace.write("extra.yaml", "b: 2")
    main(["sweep.yaml", "--seeds", "1", "--config", "extra.yaml", "--set", "data.root=here", "--jobs", "7"])
    call = next(call for call in workplace.calls() if call["row"] == "mc-s0")
    assert call["arguments"][3:-1] == [
        "--config=extra.yaml", "--data.root=here", "--components.separate=true", "--components.context=true",
        "--seed_everything=0",
    ]  # fmt: skip


def test_a_dry_run_prints_the_commands_and_runs_nothing(workplace, capsys):
    assert main(["sweep.yaml", "--dry-run"]) == 0
    assert "mc: /usr/bin/env" in capsys.readouterr().out
    assert workplace.names() == [] and not workplace.out.exists()


@pytest.mark.parametrize(
    ("flags", "sentence"),
    [(["--jobs", "0"], "--jobs 0"), (["--seeds", "0"], "--seeds 0"), (["--set", "data.root"], "--set data.root")],
)
def test_flags_that_mean_nothing_are_refused(workplace, flags, sentence):
    with pytest.raises(SagError, match=sentence):
        main(["sweep.yaml", *flags])


def test_importing_the_sweep_does_not_import_torch():
    code = "import sys, sag.sweep; sys.exit('torch' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_rows_that_a_sweep_beside_has_finished_are_copied(workplace, capsys):
    main(["sweep.yaml"])
    workplace.forget()
    assert main(["sweep.yaml", "--out", "runs/second"]) == 0
    assert workplace.names() == [] and "(from runs/trial too" in capsys.readouterr().out
    for name in ALL:
        status = json.loads((workplace.folder / "runs" / "second" / name / "status.json").read_text())
        assert status["state"] == "finished" and status["taken_from"] == f"runs/trial/{name}"
        assert (workplace.folder / "runs" / "second" / name / "log.txt").is_file()
    assert not list((workplace.folder / "runs" / "second").glob(".*.[0-9]*"))
    main(["sweep.yaml", "--out", "runs/third", "--set", "a=2"])
    assert set(workplace.names()) == ALL, "another command"


def test_rows_of_sweeps_elsewhere_or_unfinished_are_not_copied(workplace):
    workplace.wishes(c={"fails": "the scene is empty"})
    main(["sweep.yaml"])
    workplace.wishes()
    workplace.forget()
    main(["sweep.yaml", "--out", "runs/second"])
    assert workplace.names() == ["c"]
    workplace.forget()
    main(["sweep.yaml", "--out", "elsewhere/second"])
    assert set(workplace.names()) == ALL
