"""Motions as vectors, one for each frame."""

import torch

from sag.models.scale import MotionScale
from sag.types import Batch


def test_vectors_and_back(scale: MotionScale, batch: Batch) -> None:
    vectors = scale.vectors(batch.motion)
    assert vectors.shape == (4, 65, 57)
    back = scale.continued(batch.motion, vectors[:, 1:])
    torch.testing.assert_close(back.joints, batch.motion.joints)
    torch.testing.assert_close(back.trajectory, batch.motion.trajectory)


def test_vectors_are_z_scores_of_the_generated_frames(scale: MotionScale, toy) -> None:
    vectors = scale.vectors(toy.training_motion)[:, 1:].flatten(0, 1)
    torch.testing.assert_close(vectors.mean(dim=0), torch.zeros(57), atol=1e-4, rtol=0)
    assert vectors.std(dim=0).max() < 1.0001


def test_vectors_do_not_tell_where_a_motion_starts(scale: MotionScale, batch: Batch) -> None:
    before = scale.vectors(batch.motion)
    batch.motion.start += 2
    assert torch.equal(scale.vectors(batch.motion), before)


def test_a_motion_goes_on_from_the_frame_that_is_given(scale: MotionScale, batch: Batch) -> None:
    motion = scale.continued(batch.motion, torch.randn(4, 64, 57))
    assert torch.equal(motion.joints[:, 0], batch.motion.joints[:, 0])
    assert (motion.pose[:, :, scale.root] == 0).all()
