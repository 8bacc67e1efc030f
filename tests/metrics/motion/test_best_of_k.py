"""Best of K: the least error at its time, never worse for more samples."""

import jaxtyping
import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor
from toy_data import walks

from sag.errors import SagError
from sag.metrics.motion.best_of_k import BestOfK, motion_error
from sag.skeleton import GTA_IM_19

ROOT = GTA_IM_19.root_index
FPS = 30.0


def motions(count: int, seed: int = 0) -> Tensor:
    return torch.from_numpy(walks(count, np.random.default_rng(seed))).double()


def errors(samples: Tensor, joints: Tensor, **options) -> dict[str, float]:
    metric = BestOfK(ROOT, **{"fps": FPS, **options})
    metric.update(samples, joints)
    return {name: float(value) for name, value in metric.compute().items()}


def test_equals_its_definition():
    samples, joints = motions(15, 1).unflatten(0, (3, 5)), motions(3)
    found = errors(samples, joints)
    others = [place for place in range(19) if place != ROOT]
    for seconds, frame in ((0.5, 15), (1, 30), (1.5, 45), (2, 60)):
        path = np.linalg.norm((samples[:, :, frame, ROOT] - joints[:, None, frame, ROOT]).numpy(), axis=-1)
        a, b = (x[..., frame, others, :] - x[..., frame, ROOT, None, :] for x in (samples, joints))
        pose = np.linalg.norm((a - b[:, None]).numpy(), axis=-1).mean(-1)
        assert found[f"path_{seconds:g}"] == pytest.approx(path.min(1).mean())
        assert found[f"pose_{seconds:g}"] == pytest.approx(pose.min(1).mean())
    assert len(found) == 8


@given(seed=st.integers(0, 1000), k=st.integers(1, 6))
@settings(max_examples=20, deadline=None)
def test_more_samples_never_make_it_worse(seed, k):
    samples, joints = motions(14, seed + 1).unflatten(0, (2, 7)), motions(2, seed)
    fewer, more = errors(samples[:, :k], joints), errors(samples, joints)
    assert all(more[name] <= fewer[name] for name in more)


def test_the_truth_among_the_samples_is_enough():
    joints = motions(3)
    samples = torch.cat([motions(12, 1).unflatten(0, (3, 4)), joints[:, None]], dim=1)
    assert set(errors(samples, joints).values()) == {0.0}


def test_path_and_pose_are_blind_to_one_another_and_to_other_times():
    joints = motions(3)
    shifted = errors((joints + torch.tensor([0.0, 0.3, 0.4]))[:, None], joints)
    assert all(value == pytest.approx(0.5 if name.startswith("path") else 0) for name, value in shifted.items())
    posed = joints + 0.1 * (torch.arange(19) != ROOT)[:, None] * torch.tensor([1.0, 0, 0])
    found = errors(posed[:, None], joints)
    assert all(value == pytest.approx(0 if name.startswith("path") else 0.1) for name, value in found.items())
    late = joints.clone()
    late[:, 31:] += 1
    found = errors(late[:, None], joints)
    assert found["path_1"] == 0 and found["path_1.5"] == pytest.approx(3**0.5)


def test_times_are_read_at_the_nearest_frame_of_any_rate():
    assert BestOfK(ROOT, fps=5).frames == [3, 5, 8, 10]
    assert BestOfK(ROOT, fps=30, seconds=(2, 64 / 30)).frames == [60, 64]


def test_batches_make_no_difference():
    samples, joints = motions(21, 1).unflatten(0, (7, 3)), motions(7)
    metric = BestOfK(ROOT, FPS)
    for some, true in zip(samples.split(3), joints.split(3)):
        metric.update(some, true)
    assert {k: float(v) for k, v in metric.compute().items()} == pytest.approx(errors(samples, joints), rel=1e-12)
    assert motion_error(samples, joints, ROOT).path.shape == (7, 3, 65)


def test_refuses():
    joints = motions(2)
    with pytest.raises(SagError, match=r"2\.2 s, which is frame 66 at 30 fps"):
        BestOfK(ROOT, FPS, seconds=(1, 2.2))
    with pytest.raises(SagError, match="frame 0 at 30 fps"):
        BestOfK(ROOT, FPS, seconds=(0,))
    metric = BestOfK(ROOT, FPS)
    with pytest.raises(SagError, match="before any window"):
        metric.compute()
    with pytest.raises(SagError, match=r"true motions.*not finite"):
        metric.update(joints[:, None], joints / 0)
    with pytest.raises(SagError, match=r"samples.*65 frames"):
        metric.update(joints[:, None, 1:], joints[:, 1:])


def test_refuses_samples_of_other_windows_than_the_true_motions(monkeypatch):
    monkeypatch.setattr(jaxtyping.config, "jaxtyping_disable", True)  # as it is where shapes are not checked
    with pytest.raises(SagError, match=r"shape \(1, 3, 65, 19, 3\) for true motions of shape \(2, 65, 19, 3\)"):
        BestOfK(ROOT, FPS).update(motions(3, 1)[None], motions(2))
