import pytest
import torch

from sag.components import Components, Network, build_encoder, build_generator
from sag.models.bones import KeptBones
from sag.models.sampler import Sampler
from sag.models.scale import MotionScale
from sag.skeleton import GTA_IM_19, PROX_16, Skeleton
from sag.types import Batch

BODIES = [GTA_IM_19, PROX_16]


def bones(skeleton: Skeleton, joints: torch.Tensor) -> torch.Tensor:
    start, end = torch.as_tensor(skeleton.bone_index).T
    return joints[..., end, :] - joints[..., start, :]


def poses(skeleton: Skeleton, *shape: int) -> torch.Tensor:
    joints = torch.randn(*shape, len(skeleton.joints), 3, generator=torch.Generator().manual_seed(3)).double()
    return joints - joints[..., skeleton.root_index, None, :]


@pytest.mark.parametrize("skeleton", BODIES, ids=lambda s: s.name)
def test_bones_are_as_long_as_in_frame_0_and_point_where_they_did(skeleton: Skeleton) -> None:
    drawn, first = poses(skeleton, 2, 5), poses(skeleton, 2)
    kept = KeptBones(skeleton)(drawn, first)
    lengths = bones(skeleton, first).norm(dim=-1)[:, None].expand(-1, 5, -1)
    assert torch.allclose(bones(skeleton, kept).norm(dim=-1), lengths, atol=1e-12)
    along = torch.nn.functional.cosine_similarity(bones(skeleton, kept), bones(skeleton, drawn), dim=-1)
    assert torch.allclose(along, torch.ones_like(along), atol=1e-12)


@pytest.mark.parametrize("skeleton", BODIES, ids=lambda s: s.name)
def test_the_root_stays_and_lengths_kept_already_change_nothing(skeleton: Skeleton) -> None:
    keeping = KeptBones(skeleton)
    kept = keeping(poses(skeleton, 2, 5), poses(skeleton, 2))
    assert kept[:, :, skeleton.root_index].abs().max() == 0
    assert torch.allclose(keeping(kept, poses(skeleton, 2)), kept, atol=1e-12)


def test_gradients_are_exact_and_stay_finite_where_a_bone_has_shrunk_to_nothing() -> None:
    keeping, first = KeptBones(PROX_16), poses(PROX_16, 1)
    drawn = poses(PROX_16, 1, 2).requires_grad_()
    assert torch.autograd.gradcheck(lambda pose: keeping(pose, first), drawn)
    nothing = torch.zeros(1, 2, 16, 3, dtype=torch.float64, requires_grad=True)
    keeping(nothing, first).sum().backward()
    assert nothing.grad is not None and nothing.grad.isfinite().all()


@pytest.mark.parametrize("separate", [True, False], ids=["separate", "joint"])
def test_a_generator_keeps_bones_where_asked_and_only_there(separate: bool, batch: Batch, scale: MotionScale) -> None:
    drift = {}
    for choice in ("free", "kept"):
        network = Network(width=0.1, bones=choice)
        torch.manual_seed(0)
        generator = build_generator(Components(separate=separate), network, GTA_IM_19, scale)
        sampler = Sampler(build_encoder(network), generator, scale).eval()
        joints = sampler(batch.scene, batch.motion, torch.Generator().manual_seed(0)).joints
        lengths = bones(GTA_IM_19, joints).norm(dim=-1)
        drift[choice] = (lengths / lengths[:, :1] - 1).abs().max()
    assert drift["kept"] < 1e-5 < 0.05 < drift["free"]
