"""From one motion into another: ends, bones, and no jump of place or velocity."""

import numpy as np
import pytest
import torch
from torch import Tensor
from toy_data import walks

from sag.geometry.crossfade import crossfaded, smoothstep
from sag.skeleton import GTA_IM_19, PROX_16

ROOT, BONES = GTA_IM_19.root_index, GTA_IM_19.bone_index


def lengths(joints: Tensor) -> Tensor:
    return (joints[:, :, BONES[:, 1]] - joints[:, :, BONES[:, 0]]).norm(dim=-1)


def meeting(frames: int) -> Tensor:
    """Four people who walk."""
    return torch.from_numpy(walks(4, np.random.default_rng(0))).double()[:, :frames]


def going_on(frames: int) -> Tensor:
    """The same people from the same frame on, who go another way."""
    before = meeting(frames)
    turn = torch.linalg.qr(torch.randn(3, 3, generator=torch.manual_seed(0)).double())[0]
    return (before - before[:, :1]) @ turn + before[:, :1]


def test_begins_as_the_one_and_goes_on_as_the_other():
    before, after = meeting(8), going_on(65)
    mixed = crossfaded(before, after, BONES, ROOT)
    assert mixed.shape == after.shape and torch.equal(mixed[:, 0], before[:, 0])
    moved = mixed[:, 8:] - after[:, 8:]
    assert torch.allclose(moved, moved[:, :1, ROOT : ROOT + 1].expand_as(moved), atol=1e-12)
    poses = [joints - joints[:, :, ROOT : ROOT + 1] for joints in (mixed, after)]
    assert torch.allclose(poses[0][:, 8:], poses[1][:, 8:])


def test_without_frames_to_share_nothing_is_mixed():
    after = going_on(65)
    assert torch.equal(crossfaded(after[:, :1], after, BONES, ROOT), after)


def test_a_motion_into_itself_is_itself():
    before = meeting(65)
    assert torch.allclose(crossfaded(before[:, :20], before, BONES, ROOT), before, atol=1e-12)


@pytest.mark.parametrize("skeleton", [GTA_IM_19, PROX_16], ids=lambda s: s.name)
def test_bones_turn_and_do_not_shrink(skeleton):
    bones, root = skeleton.bone_index, skeleton.root_index
    generator = torch.manual_seed(1)
    before, after = (torch.zeros(3, 12, len(skeleton.joints), 3).double() for _ in range(2))
    for joints in (before, after):
        for parent, child in bones:
            way = torch.randn(3, 1, 3, generator=generator).double()
            joints[:, :, child] = joints[:, :, parent] + 0.3 * way / way.norm(dim=-1, keepdim=True)
    mixed = crossfaded(before, after, bones, root)
    found = (mixed[:, :, bones[:, 1]] - mixed[:, :, bones[:, 0]]).norm(dim=-1)
    assert torch.allclose(found, torch.full_like(found, 0.3))
    plain = torch.lerp(before, after, torch.full((1,), 0.5).double())
    assert (plain[:, :, bones[:, 1]] - plain[:, :, bones[:, 0]]).norm(dim=-1).mean() < 0.25


def test_lengths_that_differ_pass_from_one_to_the_other():
    before = meeting(10)
    mixed = lengths(crossfaded(before, 1.5 * before, BONES, ROOT)) / lengths(before)
    assert torch.allclose(mixed, (1 + 0.5 * smoothstep(torch.arange(10).double() / 10))[:, None])


@pytest.mark.parametrize("joint", [ROOT, 4], ids=["root", "wrist"])
def test_place_and_velocity_pass_over_without_a_jump(joint):
    """With ever more frames over the same second, the largest change of velocity between two goes to nothing."""
    changes = []
    for frames in (100, 1000):
        time = torch.linspace(-1, 2, 3 * frames + 1).double()[None, :, None, None]
        people = meeting(1)
        before, after = people + time, people + time * torch.tensor([-1.0, 0.5, 0])
        before[:, :, 4, 1] += 0.2 * time[:, :, 0, 0].sin()
        shared = slice(frames, 2 * frames)
        mixed = crossfaded(before[:, shared], after[:, frames:], BONES, ROOT)
        velocity = torch.cat([before[:, :frames], mixed], dim=1)[:, :, joint].diff(dim=1) * frames
        changes.append(velocity.diff(dim=1).norm(dim=-1).max())
    assert changes[1] < 0.15 * changes[0] < 0.02


def test_the_root_is_never_faster_than_both():
    motions = meeting(16), going_on(65), crossfaded(meeting(16), going_on(65), BONES, ROOT)
    before, after, mixed = (joints[:, :, ROOT].diff(dim=1).norm(dim=-1).amax(1) for joints in motions)
    assert (mixed <= torch.maximum(before, after) + 1e-9).all()
