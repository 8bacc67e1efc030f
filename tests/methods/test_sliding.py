"""Long motions: one window is untouched, seams are smooth, and only frame 0 of each window is ever seen."""

from dataclasses import replace
from itertools import pairwise

import pytest
import torch
from torch import Generator, Tensor

from sag.components import Network
from sag.errors import SagError
from sag.geometry.camera import project
from sag.methods import CSGN, HPGAN, SAG, Cao, GroundTruth, TwoStage
from sag.methods.base import Method
from sag.methods.sliding import sample_long, window_starts
from sag.scoring import Evaluation
from sag.types import Batch, Motion

TIME = torch.arange(65.0)[:, None]


class Walker(Method):
    """Walks straight on at a speed that it draws, a new one in every window; keeps what it was given."""

    def __init__(self, speed: float = 0.02) -> None:
        super().__init__("gta_im_19", Evaluation())
        self.speed = speed
        self.seen: list[Batch] = []

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        self.seen.append(batch)
        velocity = self.speed * torch.randn(len(batch), 1, 3, generator=generator)
        pose = batch.motion.pose[:, :1].repeat(1, 65, 1, 1)
        pose[:, :, 0, 0] += 0.05 * torch.sin(TIME[:, 0] / 5)
        return Motion(batch.motion.start, velocity * TIME, pose)


def seeded(seed: int = 0) -> Generator:
    return torch.Generator().manual_seed(seed)


def roots_of(method: Method, batch: Batch, frames: int, overlap: int) -> Tensor:
    return sample_long(method, batch, frames, overlap, seeded())[:, :, method.skeleton.root_index]


@pytest.mark.parametrize("overlap", [1, 8, 32])
def test_one_window_is_what_the_method_draws(batch, toy, overlap):
    for method in (Walker(), SAG(network=Network(width=0.05), image_size=toy.image_size).eval()):
        drawn = method.sample(batch, seeded()).joints
        assert torch.equal(sample_long(method, batch, 65, overlap, seeded()), drawn)


@pytest.mark.parametrize("kind", [SAG, CSGN, HPGAN, TwoStage, Cao])
def test_every_method_goes_on(batch, toy, kind):
    size = {"image_size": toy.image_size} if kind is SAG else {}
    method = kind(network=Network(width=0.05), **size).eval()
    with torch.no_grad():
        joints = sample_long(method, batch, 150, 8, seeded())
    assert joints.shape == (4, 150, 19, 3) and joints.isfinite().all()


@pytest.mark.parametrize("overlap", [1, 2, 8, 31, 32])
@pytest.mark.parametrize("frames", [66, 100, 129, 257])
def test_any_number_of_frames(batch, frames, overlap):
    starts = window_starts(frames, overlap)
    assert starts[0] == 0 and {b - a for a, b in pairwise(starts)} == {65 - overlap}
    assert starts[-2] + 65 < frames <= starts[-1] + 65
    method = Walker()
    joints = sample_long(method, batch, frames, overlap, seeded())
    assert joints.shape == (4, frames, 19, 3) and len(method.seen) == len(starts)
    longer = sample_long(method, batch, frames + 40, overlap, seeded())
    alone = min(frames, starts[-1] + 65 - overlap)
    assert torch.equal(longer[:, :alone], joints[:, :alone])


def test_the_first_window_is_unchanged_outside_the_overlap(batch):
    method = Walker()
    first, joints = method.sample(batch, seeded()).joints, sample_long(method, batch, 150, 8, seeded())
    assert torch.equal(joints[:, :58], first[:, :58])
    assert not torch.allclose(joints[:, 58:65], first[:, 58:65])


@pytest.mark.parametrize("overlap", [1, 8, 20])
def test_each_window_continues_a_frame_of_the_motion_at_its_place(batch, overlap):
    method = Walker()
    joints = sample_long(method, batch, 200, overlap, seeded())
    for place, start in enumerate(window_starts(200, overlap)[1:], 1):
        given = method.seen[place].motion
        assert given.pose.shape[1] == 1  # there is nothing to look ahead at
        assert torch.allclose(given.joints[:, 0], joints[:, start], atol=1e-6)
        alone = joints[:, start + overlap : start + 66 - overlap, method.skeleton.root_index].diff(dim=1)
        assert torch.allclose(alone, alone[:, :1].expand_as(alone), atol=1e-5)  # straight where nothing is mixed


def test_roots_keep_place_and_velocity_at_blended_seams(batch):
    """At plain seams the velocity jumps from one window's to the next one's; blended, it goes there step by step."""
    plain, blended = (roots_of(Walker(), batch, frames, overlap).double() for frames, overlap in ((257, 1), (210, 16)))
    differing = plain.diff(2, dim=1).norm(dim=-1)
    seams = [start - 1 for start in window_starts(257, 1)[1:]]
    jumps = differing[:, seams]
    assert differing.sum() == pytest.approx(float(jumps.sum()), rel=1e-3)  # straight but for the seams
    change = blended.diff(2, dim=1).norm(dim=-1)
    for place, start in enumerate(window_starts(210, 16)[1:]):
        around = change[:, start - 2 : start + 18]
        assert (around.amax(1) < 0.3 * jumps[:, place]).all()
    assert blended.diff(dim=1).norm(dim=-1).max() < 1.001 * plain.diff(dim=1).norm(dim=-1).max()  # nobody hurries


def test_one_seed_gives_one_motion(batch):
    first, again, other = (sample_long(Walker(), batch, 150, 8, seeded(seed)) for seed in (3, 3, 4))
    assert torch.equal(first, again)
    assert not torch.allclose(first, other)


def test_who_stands_still_has_the_same_picture_ever_after(batch):
    method = Walker(speed=0)
    sample_long(method, batch, 200, 8)
    assert len(method.seen) == 4
    for seen in method.seen:
        for name in ("image", "depth", "person", "intrinsics"):
            assert torch.equal(getattr(seen.scene, name), getattr(batch.scene, name))


def test_the_picture_follows_the_root(batch):
    method = Walker(speed=0.002)
    sample_long(method, batch, 200, 8, seeded())
    for seen in method.seen[1:]:
        pixel = project(seen.motion.start, seen.scene.intrinsics)
        assert ((pixel - torch.tensor([32, 18])).abs() < 0.51).all()
        assert torch.equal(seen.world2cam, batch.world2cam)
    assert not torch.equal(method.seen[-1].scene.image, batch.scene.image)


class Leaver(Walker):
    """Walks out of the picture to the right in its second window, and comes back in its third."""

    def sample(self, batch: Batch, generator: Generator | None = None) -> Motion:
        drawn = super().sample(batch, generator)
        step = {2: 20.0, 3: -20.0}.get(len(self.seen), 0.005)
        return replace(drawn, trajectory=TIME / 64 * torch.tensor([step, 0, 0]).expand(len(batch), 1, 3))


def test_the_picture_stays_where_the_root_leaves_it_and_follows_again(batch):
    method = Leaver()
    sample_long(method, batch, 65 + 3 * 64, 1)
    _, last, outside, back = (seen.scene for seen in method.seen)
    assert torch.equal(outside.image, last.image) and torch.equal(outside.intrinsics, last.intrinsics)
    centred = project(method.seen[3].motion.start, back.intrinsics)
    assert ((centred - torch.tensor([32, 18])).abs() < 0.51).all()


@pytest.mark.parametrize(
    ("frames", "overlap", "said"),
    [(64, 8, "64 frames; one window alone has 65"), (100, 0, "share 0 frames"), (100, 33, "share 33 frames")],
)
def test_refuses_what_no_window_can_give(batch, frames, overlap, said):
    with pytest.raises(SagError, match=said):
        sample_long(Walker(), batch, frames, overlap)


def test_refuses_a_method_that_only_repeats(batch):
    with pytest.raises(SagError, match="GroundTruth cannot go on beyond its window"):
        sample_long(GroundTruth(), batch, 66)
