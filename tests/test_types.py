import torch

from sag.types import Motion


def test_joints_are_start_trajectory_and_pose() -> None:
    joints = torch.randn(2, 65, 19, 3)
    motion = Motion.from_joints(joints, root=12)
    assert torch.allclose(motion.joints, joints, atol=1e-6)
    assert motion.trajectory[:, 0].abs().max() == 0
    assert motion.pose[:, :, 12].abs().max() == 0
    assert torch.allclose(motion.roots, joints[:, :, 12], atol=1e-6)


def test_first_is_all_that_is_given() -> None:
    motion = Motion.from_joints(torch.randn(2, 65, 19, 3), root=12)
    assert motion.first.joints.shape == (2, 1, 19, 3)
    again = motion.first.continued(motion.trajectory[:, 1:], motion.pose[:, 1:])
    assert torch.equal(again.joints, motion.joints)


def test_batches_move_and_are_indexed(batch) -> None:
    moved = batch.to(torch.device("cpu"))
    assert torch.equal(moved.motion.joints, batch.motion.joints)
    two = batch[torch.tensor([2, 0])]
    assert len(two) == 2
    assert torch.equal(two.scene.depth[1], batch.scene.depth[0])
    assert two.cloud is not None
    assert torch.equal(two.cloud.intrinsics[0], batch.cloud.intrinsics[2])
