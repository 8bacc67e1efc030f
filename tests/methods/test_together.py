"""Two processes train and test as one does: the same gradients, the same weights, the same figures.

All that they do together they do in one go, since starting them takes longest; each test looks at a part of it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from together_work import CASES, METHODS, SAG_WITH_ALL, Work, refused_strategy, work_of_two
from torch import Tensor
from torch.nn.modules.batchnorm import _BatchNorm
from two_processes import together

from sag.data.motion_file import read_motions
from sag.models.batch_norm import OverProcesses
from sag.models.erd import MotionEncoders

Done = dict[str, Any]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where all of it happens, with encoders for the data."""
    made = tmp_path_factory.mktemp("together")
    data = Work(made / "data", made, 1).data()
    torch.manual_seed(1)
    MotionEncoders("gta_im_19", width=0.02).save(data.encoder_path, data.cache.fingerprint)
    return made


@pytest.fixture(scope="module")
def two(folder: Path) -> list[Done]:
    """What each of two processes found."""
    return together(work_of_two, folder, folder / "data", folder / "two")


@pytest.fixture(scope="module")
def one(folder: Path) -> Done:
    """What one process finds alone."""
    return Work(folder / "data", folder / "one", 1).all()


def apart(found: dict[str, Tensor], wanted: dict[str, Tensor]) -> float:
    """The largest difference of two sets of tensors, as a share of the largest number of the tensor."""
    assert found.keys() == wanted.keys()
    return max(float((found[n] - w).abs().max() / w.abs().max().clamp_min(1e-3)) for n, w in wanted.items())


def test_they_were_two(two: list[Done], one: Done) -> None:
    assert [done["processes"] for done in (*two, one)] == [2, 2, 1]


@pytest.mark.parametrize("name", METHODS)
def test_a_step_has_the_gradient_that_one_process_has_on_the_whole_batch(name: str, two: list[Done], one: Done) -> None:
    steps = one["trained"][name]["steps"]
    for done in two:
        found = done["trained"][name]["steps"]
        assert len(found) == len(steps) >= 3
        assert max(apart(*pair) for pair in zip(found, steps)) < 1e-10


@pytest.mark.parametrize("name", METHODS)
def test_a_training_ends_alike_in_both_and_where_one_process_ends(name: str, two: list[Done], one: Done) -> None:
    first, second, alone = (done["trained"][name] for done in (*two, one))
    assert first["weights"].keys() == second["weights"].keys()
    assert all(torch.equal(value, second["weights"][key]) for key, value in first["weights"].items())
    # Adam makes steps of one size of gradients that are zero but for rounding, so weights part sooner than gradients.
    assert apart(first["weights"], alone["weights"]) < 1e-6
    assert first["logged"] == second["logged"] == pytest.approx(alone["logged"], rel=1e-5, abs=1e-6)


def test_batch_norms_apart_have_another_gradient(two: list[Done], one: Done) -> None:
    """The control: where each process normalises by its own windows, the same comparison finds it."""
    steps = one["trained"][SAG_WITH_ALL]["steps"]
    assert apart(two[0]["apart"]["steps"][0], steps[0]) > 1e-2
    assert apart(one["apart"]["steps"][0], steps[0]) == 0


def test_every_batch_norm_of_every_method_sees_all_processes() -> None:
    norms = [module for make in METHODS.values() for module in make().modules() if isinstance(module, _BatchNorm)]
    assert len(norms) > 100
    assert all(isinstance(norm, OverProcesses) for norm in norms)


def test_depth_that_is_known_unevenly_weighs_as_in_one_batch(two: list[Done], one: Done) -> None:
    for key in ("loss", "gradient"):
        assert float(sum(done["depth"][key] for done in two)) / 2 == pytest.approx(float(one["depth"][key]), rel=1e-12)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_figure_of_a_test_is_that_of_one_process(case: tuple[str, int], two: list[Done], one: Done) -> None:
    wanted = one["tested"][case]
    assert {"motion_fid/average", "motion_fid_interval/low", "non_collision/average"} <= wanted.keys()
    for done in two:
        assert done["tested"][case] == pytest.approx(wanted, rel=1e-12, abs=1e-12, nan_ok=True)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_files_of_a_test_are_those_of_one_process(
    case: tuple[str, int], two: list[Done], one: Done, folder: Path
) -> None:
    alone, both = (folder / place / f"{case[0]}-{case[1]}" for place in ("one", "two"))
    assert sorted(p.name for p in alone.iterdir()) == sorted(p.name for p in both.iterdir())
    found, wanted = (json.loads((place / "metrics.json").read_text()) for place in (both, alone))
    assert found["protocol"] == wanted["protocol"] and found["protocol"]["motions"] == 6
    motions, expected = (read_motions(place / "predictions.npz") for place in (both, alone))
    assert np.array_equal(motions.index, expected.index) and len(set(motions.index)) == 6
    assert np.array_equal(motions.joints, expected.joints)


def test_an_interrupted_run_goes_on_to_the_same_end(two: list[Done]) -> None:
    for done in two:
        assert done["left"] is None
        ending, whole = done["resumed"]["weights"], done["whole"]["weights"]
        assert all(torch.equal(ending[key], value) for key, value in whole.items())


def test_a_run_goes_on_with_another_number_of_processes(two: list[Done], one: Done, folder: Path) -> None:
    continued = Work(folder / "data", folder / "two", 1).part("left", None)
    assert continued is not None
    close = {"rel": 2e-3, "abs": 1e-4}  # so small a network parts in float32 soon
    assert continued["logged"] == pytest.approx(two[0]["whole"]["logged"], **close)
    assert continued["logged"] != pytest.approx(one["whole"]["logged"], **close)


def test_both_say_what_is_wrong(two: list[Done], one: Done) -> None:
    first, second = (done["refused"] for done in two)
    assert first == second
    assert "3 windows cannot be shared out evenly: make it a multiple of 2" in first["uneven"]
    assert one["refused"]["uneven"] == "nothing was refused"
    assert first["diverged"] == one["refused"]["diverged"]
    assert first["diverged"].startswith("Diverged: train/critic/")


def test_a_strategy_that_shares_out_weights_is_refused() -> None:
    assert "trainer.strategy is FSDPStrategy, and only DDP trains" in refused_strategy()
