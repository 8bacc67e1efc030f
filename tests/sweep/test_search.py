"""Searches: what is drawn, what a search has learned, and that neither forgets anything when it is killed."""

import json
import math
import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest
import yaml

from sag.errors import SagError
from sag.sweep import main
from sag.sweep.command import Additions
from sag.sweep.definition import Metric, read_sweep
from sag.sweep.distributions import Choice, Integers, Uniform, read_distribution
from sag.sweep.rows import Row
from sag.sweep.search import Outcome, Search, outcomes
from sag.sweep.status import read_status
from sag.sweep.tracked import Tracked
from sag.sweep.trials import chance_of, draw, drawn, recorded

HERE = Path(__file__).parent
SCHEMA = json.loads((HERE / "wandb_sweep_schema.json").read_text())
SWEEPS = HERE.parents[1] / "sweeps"

PROGRAM = """
import json, math, sys, time
from pathlib import Path

options = dict(part.removeprefix("--").split("=", 1) for part in sys.argv[1:] if "=" in part)
folder = Path(options.pop("trainer.default_root_dir"))
if "rate" in options:
    rate, width, kind = float(options["rate"]), int(options["width"]), options["kind"]
    value = (math.log10(rate) + 3) ** 2 + abs(width - 4) / 4 + (kind != "good")
    with open("calls.txt", "a") as calls:
        calls.write(folder.name + "\\n")
    time.sleep(float(Path("seconds").read_text()))
    if Path("fails").exists() and kind == "bad":
        sys.exit("ValueError: a bad kind")
    value = math.nan if kind == "odd" else value
    (folder / "metrics.json").write_text(json.dumps({"metrics": {"loss": None if value != value else value}}))
else:
    (folder / "metrics.json").write_text(json.dumps({"metrics": {"loss": 0}}))
"""

SWEEP = """
program: program.py
name: trial
method: METHOD
run_cap: 12
metric: {name: test/loss, goal: minimize}
command: ["${env}", "${interpreter}", "${program}", run, --config, base.yaml, "${args}"]
parameters:
  rate: {distribution: log_uniform_values, min: 1.0e-5, max: 1.0e-1}
  width: {min: 1, max: 16}
  kind: {values: [good, bad]}
"""


@pytest.fixture
def search(workplace):
    """A place with a search in place of the grid."""
    workplace.write("program.py", PROGRAM)
    workplace.write("seconds", "0")
    workplace.write("sweep.yaml", SWEEP.replace("METHOD", "bayes"))
    return workplace


def points(workplace) -> dict[str, dict]:
    statuses = {path.parent.name: json.loads(path.read_text()) for path in workplace.out.glob("t*/status.json")}
    return {name: statuses[name]["point"] for name in sorted(statuses)}


def value(workplace, row: str) -> float:
    return json.loads((workplace.out / row / "metrics.json").read_text())["metrics"]["loss"]


@pytest.mark.parametrize(
    ("given", "read"),
    [
        ({"value": 3}, Choice((3,))),
        ({"values": [1, "x", None], "distribution": "categorical"}, Choice((1, "x", None))),
        ({"min": 1, "max": 4}, Integers(1, 4)),
        ({"min": 1, "max": 4.0}, Uniform(1.0, 4.0)),
        ({"min": 1, "max": 4, "distribution": "uniform"}, Uniform(1.0, 4.0)),
        ({"min": 0.1, "max": 10, "distribution": "log_uniform_values"}, Uniform(0.1, 10.0, logarithmic=True)),
    ],
)
def test_distributions_are_read_as_wandb_reads_them(given, read):
    assert read_distribution(given) == read
    drawn_values = [read.draw(random.Random(seed)) for seed in range(200)]
    assert all(read.holds(value) for value in drawn_values)


def test_magnitudes_are_as_likely_as_each_other_and_bounds_hold_after_rounding():
    drawn_values = [Uniform(1e-4, 1.0, logarithmic=True).draw(random.Random(seed)) for seed in range(4000)]
    shares = [sum(10.0**e <= v < 10.0 ** (e + 1) for v in drawn_values) / 4000 for e in range(-4, 0)]
    assert shares == pytest.approx([0.25] * 4, abs=0.03)
    assert 0.12345678 <= Uniform(0.12345678, 0.12345679).draw(random.Random(0)) <= 0.12345679
    assert {Integers(1, 3).draw(random.Random(seed)) for seed in range(50)} == {1, 2, 3}


@pytest.mark.parametrize(
    ("method", "line", "sentence"),
    [
        ("random", "a: {min: 2, max: 1}", "parameter 'a' has the bounds 2 and 1"),
        ("random", "a: {min: 1e-4, max: 1}", "parameter 'a' has the bound '1e-4', .* write it like 1.0e-4"),
        ("random", "a: {distribution: log_uniform_values, min: 0, max: 1}", "'min' must be above 0"),
        ("random", "a: {distribution: int_uniform, min: 0.5, max: 1}", "both must be whole numbers"),
        ("random", "a: {distribution: q_normal, mu: 0}", "parameter 'a' must be"),
        ("random", "a: {min: 1}", "parameter 'a' must be"),
        ("grid", "a: {min: 1, max: 3}", "parameter 'a' has no values that a grid could"),
        ("hyperband", "a: {value: 1}", "method 'hyperband' is not known; use one of grid, random, bayes"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_one_sentence(tmp_path, method, line, sentence):
    path = tmp_path / "s.yaml"
    path.write_text(f"{{program: p, method: {method}, run_cap: 3, parameters: {{{line}}}}}")
    with pytest.raises(SagError, match=sentence):
        read_sweep(path)


@pytest.mark.parametrize(
    ("head", "sentence"),
    [
        ("method: random", "method 'random' needs run_cap"),
        ("method: bayes, run_cap: 0", "method 'bayes' needs run_cap"),
        ("method: bayes, run_cap: 3", "method 'bayes' needs metric"),
        ("method: bayes, run_cap: 3, metric: {name: x, goal: best}", "method 'bayes' needs metric"),
    ],
)
def test_a_search_without_an_end_or_an_aim_is_refused(tmp_path, head, sentence):
    path = tmp_path / "s.yaml"
    path.write_text(f"{{program: p, {head}, parameters: {{a: {{min: 1, max: 3}}}}}}")
    with pytest.raises(SagError, match=sentence):
        read_sweep(path)


def test_a_random_search_is_the_same_whenever_it_is_asked_for(search):
    search.write("sweep.yaml", SWEEP.replace("METHOD", "random"))
    sweep = read_sweep(Path("sweep.yaml"))
    assert drawn(sweep, 0) == drawn(sweep, 0) and len(drawn(sweep, 0)) == 12
    assert drawn(sweep, 0)[3] != drawn(sweep, 1)[3]
    assert main(["sweep.yaml"]) == 0
    assert list(points(search).values()) == [trial.point for trial in drawn(sweep, 0)]
    (search.folder / "calls.txt").unlink()
    assert main(["sweep.yaml"]) == 0 and not (search.folder / "calls.txt").exists()


def test_points_are_not_drawn_twice(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("{program: p, method: random, run_cap: 50, parameters: {a: {values: [1, 2, 3]}, b: {value: 0}}}")
    sweep = read_sweep(path)
    assert sorted(trial.point["a"] for trial in drawn(sweep, 0)) == [1, 2, 3]
    assert draw(sweep, chance_of(0, 9), [{"a": a, "b": 0} for a in (1, 2, 3)]) is None


def test_a_grid_may_have_an_end(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("{program: p, run_cap: 2, parameters: {a: {values: [1, 2, 3]}}}")
    assert read_sweep(path).points() == [{"a": 1}, {"a": 2}]


def test_the_bayesian_search_finds_what_chance_does_not(search):
    pytest.importorskip("optuna")
    search.write("sweep.yaml", SWEEP.replace("METHOD", "bayes").replace("run_cap: 12", "run_cap: 30"))
    assert main(["sweep.yaml", "--jobs", "1"]) == 0
    found = [value(search, row) for row in points(search)]
    assert len(found) == 30
    assert sum(found[15:]) / 15 < 0.6 * sum(found[:10]) / 10, "later trials are where earlier ones were good"


def test_the_seeds_of_a_trial_are_averaged(search):
    pytest.importorskip("optuna")
    search.write("sweep.yaml", SWEEP.replace("METHOD", "bayes").replace("run_cap: 12", "run_cap: 3"))
    assert main(["sweep.yaml", "--seeds", "2"]) == 0
    assert [row[:5] + row[-3:] for row in points(search)] == [f"t00{n}--s{s}" for n in range(3) for s in range(2)]
    tracked = [
        Tracked(Row(row, (), "", trial=int(row[1:4]), point=point), search.out / row, read_status(search.out / row))
        for row, point in points(search).items()
    ]
    for place, figure in enumerate((1.0, 2.0, 5.0, 5.0, 3.0, None)):
        (tracked[place].folder / "metrics.json").write_text(json.dumps({"metrics": {"loss": figure}}))
    assert [outcome.value for outcome in outcomes(Metric("test/loss"), tracked)] == [1.5, 5.0, None]
    tracked[1].status = replace(tracked[1].status, state="running")
    assert [(o.value, o.ended) for o in outcomes(Metric("loss"), tracked)] == [(None, False), (5.0, True), (None, True)]


@pytest.mark.parametrize(("goal", "near"), [("minimize", (1, 6)), ("maximize", (11, 16))])
def test_the_goal_is_that_of_the_file(search, goal, near):
    pytest.importorskip("optuna")
    search.write("sweep.yaml", SWEEP.replace("METHOD", "bayes").replace("minimize", goal).replace("12", "40"))
    asked = Search(read_sweep(Path("sweep.yaml")), Additions(), None, search.out, seed=0)
    known = [Outcome({"rate": 1e-3, "width": n, "kind": "good"}, float(n), True) for n in range(1, 17)] * 2
    widths = [point["width"] for number in range(100, 110) if (point := asked.propose(number, known))]
    assert sum(near[0] <= width <= near[1] for width in widths) >= 7


def test_a_killed_search_goes_on_as_the_undisturbed_one(search, monkeypatch):
    pytest.importorskip("optuna")
    assert main(["sweep.yaml", "--jobs", "1"]) == 0
    undisturbed = points(search)
    search.out.rename(search.folder / "undisturbed")
    search.write("seconds", "0.2")
    kills, environment = 0, {**os.environ, "PYTHONPATH": os.environ["PYTHONPATH"]}
    while True:
        command = [sys.executable, "-m", "sag", "sweep", "sweep.yaml", "--jobs", "1"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, env=environment)
        begun = len(points(search))
        while process.poll() is None and len(points(search)) < begun + 3:
            time.sleep(0.02)
        if process.poll() is not None:
            break
        process.send_signal(signal.SIGKILL)
        process.wait()
        kills += 1
    assert process.returncode == 0 and kills >= 3
    assert points(search) == undisturbed


def test_trials_that_failed_or_left_no_number_do_not_end_the_search(search):
    pytest.importorskip("optuna")
    search.write("sweep.yaml", SWEEP.replace("METHOD", "bayes").replace("[good, bad]", "[good, bad, odd]"))
    search.write("fails", "")
    assert main(["sweep.yaml", "--jobs", "2"]) == 1
    assert len(points(search)) == 12
    (search.folder / "fails").unlink()
    assert main(["sweep.yaml"]) == 0, "the same command runs them again"
    assert len(points(search)) == 12


def test_a_metric_that_no_row_has_is_named(search):
    pytest.importorskip("optuna")
    search.write("sweep.yaml", SWEEP.replace("METHOD", "bayes").replace("test/loss", "test/los"))
    with pytest.raises(SagError, match=r"metric 'test/los' is not in .*metrics\.json; did you mean 'test/loss'\?"):
        main(["sweep.yaml"])
    assert "running" not in search.states().values(), "what ran was ended in order"


def test_points_that_the_file_does_not_allow_any_more_are_forgotten(search):
    search.write("sweep.yaml", SWEEP.replace("METHOD", "random"))
    main(["sweep.yaml"])
    narrow = SWEEP.replace("METHOD", "random").replace("max: 16", "max: 5")
    search.write("narrow.yaml", narrow)
    kept = recorded(read_sweep(Path("narrow.yaml")), search.out)
    assert [trial.point for trial in kept] == [point for point in points(search).values() if point["width"] <= 5]
    assert 0 < len(kept) < 12


def test_a_bayesian_search_through_slurm_must_stay(search):
    pytest.importorskip("optuna")
    with pytest.raises(SagError, match="--detach: a Bayesian search"):
        main(["sweep.yaml", "--slurm", "--detach"])


@pytest.mark.parametrize("path", sorted(SWEEPS.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_sweep_file_is_valid_for_wandb(path):
    """By the schema that `wandb sweep` is checked against: github.com/wandb/sweeps, 0.3.0."""
    jsonschema.Draft7Validator(SCHEMA).validate(yaml.safe_load(path.read_text()))


def test_what_wandb_takes_and_refuses_is_told_by_its_schema(tmp_path):
    validator = jsonschema.Draft7Validator(SCHEMA)
    validator.validate(yaml.safe_load(SWEEP.replace("METHOD", "bayes")))
    assert not validator.is_valid(yaml.safe_load(SWEEP.replace("METHOD", "guess")))
    assert math.isclose(read_sweep_rate(tmp_path).low, 1e-5)


def read_sweep_rate(folder: Path) -> Uniform:
    (folder / "s.yaml").write_text(SWEEP.replace("METHOD", "random"))
    rate = read_sweep(folder / "s.yaml").parameters["rate"]
    assert isinstance(rate, Uniform)
    return rate
