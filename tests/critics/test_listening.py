"""Critics made for it are seen through: deaf to the motion, deaf to the scene, keen on height, aware of the floor."""

import math

import pytest
import torch
from toy_runs import toy_run

from sag.cli import main
from sag.critics.listening import STEP, lifted, listening_of, variance_shares
from sag.geometry.camera import to_world
from sag.models.critics import Critic
from sag.models.scale import MotionScale
from sag.runs import read_run
from sag.skeleton import GTA_IM_19


class Made(Critic):
    """Looks at the joints and scores them by a function of (joints, f)."""

    def __init__(self, score, upwards=None):
        super().__init__(torch.nn.Identity(), MotionScale(19, GTA_IM_19.root_index))
        self.score = score
        self.upwards = upwards

    def view(self, motion, scene):
        joints = motion.joints
        return joints if self.upwards is None else (joints * self.upwards[:, None, None]).sum(-1)

    def forward(self, view, condition):
        return self.score(view.flatten(1), condition.feature)


@pytest.fixture
def heard(toy, tmp_path):
    """What is heard of critics, by name, in the test windows of the toy data."""
    method = read_run(toy_run(tmp_path / "run", toy)).method
    batch = next(iter(toy.test_dataloader()))

    def listen(**critics):
        method.critics = torch.nn.ModuleDict(critics)
        return listening_of(method, batch, torch.Generator().manual_seed(0))

    return listen


def test_each_source_has_its_share(heard):
    found = heard(
        deaf=Made(lambda x, f: f.sum(1) + 0 * x.sum(1)),
        blind=Made(lambda x, f: x.sum(1)),
        constant=Made(lambda x, f: 0 * x.sum(1) + 3),
    )
    assert (found["deaf"].motion, found["deaf"].feature) == pytest.approx((0, 100), abs=1e-3)
    assert (found["blind"].motion, found["blind"].feature) == pytest.approx((100, 0), abs=1e-3)
    assert (found["constant"].motion, found["constant"].feature, found["constant"].both) == (0, 0, 0)
    assert found["deaf"].pull == 0


def test_a_product_is_both():
    rows = torch.tensor([-1.0, 1.0])
    assert variance_shares(rows[:, None] * rows[None]) == pytest.approx((0, 0, 100))
    assert variance_shares(rows[:, None] + 2 * rows[None]) == pytest.approx((20, 80, 0))


def test_pull_is_the_norm_of_the_gradient_at_generated_frames(heard):
    found = heard(leaning=Made(lambda x, f: 2 * x.sum(1)))
    assert found["leaning"].pull == pytest.approx(2 * math.sqrt(64 * 19 * 3), rel=1e-4)


def test_lifting_is_along_the_worlds_vertical(toy):
    batch = next(iter(toy.test_dataloader()))
    higher = lifted(batch.motion, batch.world2cam[:, :3, 2], STEP)
    moved = to_world(higher.joints, batch.world2cam) - to_world(batch.motion.joints, batch.world2cam)
    wanted = torch.zeros_like(moved)
    wanted[:, 1:, :, 2] = STEP
    assert torch.allclose(moved, wanted, atol=1e-5)


def test_who_is_keen_on_height_prefers_every_lifted_motion_and_who_knows_the_floor_none(heard, toy):
    upwards = next(iter(toy.test_dataloader())).world2cam[:, :3, 2]
    true = (next(iter(toy.test_dataloader())).motion.joints * upwards[:, None, None]).sum(-1).flatten(1)
    found = heard(
        keen=Made(lambda x, f: x.sum(1), upwards),
        aware=Made(lambda x, f: -(x - true).abs().sum(1), upwards),
    )
    assert (found["keen"].lifted, found["keen"].sunk) == (0, 100)
    assert (found["aware"].lifted, found["aware"].sunk, found["aware"].real) == (100, 100, 100)


def test_every_critic_of_every_run_has_a_line(toy, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "140")
    for name in ("a", "b"):
        toy_run(tmp_path / "sweep" / name, toy)
    assert main(["critics", str(tmp_path / "sweep"), "--windows", "2"]) == 0
    shown = capsys.readouterr().out
    assert [shown.count(name) for name in ("trajectory", "pose ")] == [2, 2]
    assert "2 validation windows of toy" in shown


def test_too_few_windows_are_refused(toy, tmp_path, capsys):
    toy_run(tmp_path / "run", toy)
    assert main(["critics", str(tmp_path / "run"), "--windows", "1"]) == 2
    assert "--windows is 1, and" in capsys.readouterr().err
