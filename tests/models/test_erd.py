"""ERD and its file."""

import pytest
import torch

from sag.errors import SagError
from sag.models.erd import ERD, MotionEncoders


@pytest.fixture
def encoders() -> MotionEncoders:
    encoders = MotionEncoders("gta_im_19", width=0.04)
    encoders.set_statistics(torch.randn(6, 64, 19, 3) * 0.4 + 0.1)
    return encoders.eval()


def test_sizes_of_the_full_network():
    sizes = {name: tuple(p.shape) for name, p in ERD(19).named_parameters() if name.endswith(("weight", "_l0", "_l1"))}
    assert [sizes[f"embed.{i}.weight"] for i in (0, 2)] == [(500, 57), (500, 500)]
    assert sizes["memory.weight_ih_l0"] == (4000, 500) and sizes["memory.weight_hh_l1"] == (4000, 1000)
    assert [sizes[f"step.{i}.weight"] for i in (0, 2, 4)] == [(500, 1000), (100, 500), (57, 100)]
    assert ERD(19, width=0.128).dimension == 128


def test_shapes(encoders):
    clips = torch.randn(5, 16, 19, 3)
    found = encoders.features(clips, (2, 16))
    assert set(found) == {(frames, length) for frames in (16, 32, 64) for length in (2, 16)}
    assert all(features.shape == (5, encoders.dimension) for features in found.values())
    network = encoders.of(32)
    assert network(network.normalised(clips)).shape == (5, 16, 57)


def test_features_are_states_of_the_second_layer_from_zero(encoders):
    clips, network = torch.randn(5, 16, 19, 3), encoders.of(16)
    start = torch.zeros(2, 5, encoders.dimension)
    _, (hidden, _) = network.memory(network.embed(network.normalised(clips[:, :8])), (start, start))
    torch.testing.assert_close(network.features(clips, [8])[0], hidden[1])


def test_a_feature_sees_its_frames_and_none_after_them(encoders):
    clips = torch.randn(5, 16, 19, 3)
    later, earlier = clips.clone(), clips.clone()
    later[:, 8:] += 1
    earlier[:, 7:8] += 1
    before, after, changed = (encoders.of(64).features(x, [8])[0] for x in (clips, later, earlier))
    assert torch.equal(before, after) and not torch.allclose(before, changed)


def test_without_a_foreseen_step_the_next_frame_is_the_last(encoders):
    network = encoders.of(16)
    for parameter in network.step[-1].parameters():
        torch.nn.init.zeros_(parameter)
    frames = torch.randn(2, 9, 57)
    assert torch.equal(network(frames), frames)


def test_statistics_make_z_scores():
    network, clips = ERD(19, 0.04), torch.randn(50, 64, 19, 3) * 0.3 + 2
    network.set_statistics(clips)
    scores = network.normalised(clips)
    torch.testing.assert_close(scores.mean((0, 1)), torch.zeros(57), atol=1e-4, rtol=0)
    torch.testing.assert_close(scores.std((0, 1)), torch.ones(57), atol=1e-4, rtol=0)


def test_joints_that_hardly_move_are_not_blown_up():
    network = ERD(19, 0.04)
    network.set_statistics(torch.zeros(4, 64, 19, 3))
    assert network.normalised(torch.full((1, 2, 19, 3), 0.01)).max() <= 1


def test_gradients_reach_every_weight(encoders):
    for network in encoders.networks.values():
        network(torch.randn(2, 5, 57)).square().sum().backward()
    assert all(p.grad is not None and p.grad.abs().sum() > 0 for p in encoders.parameters())


def test_it_learns_to_foresee(encoders):
    network, frames = encoders.of(16), torch.arange(17.0)[None, :, None] * 0.1 * torch.randn(8, 1, 57)
    optimizer = torch.optim.Adam(network.parameters(), 3e-3)
    errors = []
    for _ in range(60):
        error = (network(frames[:, :-1]) - frames[:, 1:]).square().mean()
        optimizer.zero_grad()
        error.backward()
        optimizer.step()
        errors.append(float(error.detach()))
    assert errors[-1] < 0.5 * errors[0]


def test_saving_and_loading_gives_the_same_features(encoders, tmp_path):
    path = tmp_path / "new" / "encoders.pt"
    encoders.save(path, "abc")
    loaded = MotionEncoders.load(path, "gta_im_19", "abc")
    clips = torch.randn(3, 8, 19, 3)
    for key, features in encoders.features(clips, (4, 8)).items():
        assert torch.equal(features, loaded.features(clips, (4, 8))[key])
    assert [p.name for p in path.parent.iterdir()] == ["encoders.pt"]
    assert not loaded.training and not any(p.requires_grad for p in loaded.parameters())


def test_a_failed_save_leaves_the_old_file(encoders, tmp_path, monkeypatch):
    path = tmp_path / "encoders.pt"
    encoders.save(path, "old")

    def no_room(*_: object) -> None:
        raise OSError("No space left on device")

    monkeypatch.setattr("sag.files.os.fsync", no_room)
    with pytest.raises(OSError, match="No space"):
        encoders.save(path, "new")
    assert [p.name for p in tmp_path.iterdir()] == ["encoders.pt"]
    MotionEncoders.load(path, fingerprint="old")


@pytest.mark.parametrize("share", [0.05, 0.3, 0.6, 0.9])
def test_a_flipped_bit_is_noticed(encoders, tmp_path, share):
    path = tmp_path / "encoders.pt"
    encoders.save(path, "abc")
    content = bytearray(path.read_bytes())
    content[int(share * len(content))] ^= 16
    path.write_bytes(content)
    with pytest.raises(SagError, match=r"encoders\.pt is damaged"):
        MotionEncoders.load(path)


@pytest.mark.parametrize("content", [b"", b"no archive", None], ids=["empty", "text", "other archive"])
def test_a_foreign_file_is_refused(tmp_path, content):
    path = tmp_path / "encoders.pt"
    path.write_bytes(content) if content is not None else torch.save({"weights": {}}, path)
    with pytest.raises(SagError, match=r"encoders\.pt is damaged or holds no motion encoders"):
        MotionEncoders.load(path)


def test_half_a_file_is_refused(encoders, tmp_path):
    path = tmp_path / "encoders.pt"
    encoders.save(path, "abc")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(SagError, match="is damaged"):
        MotionEncoders.load(path)


def test_encoders_of_another_skeleton_or_other_data_are_refused(encoders, tmp_path):
    path = tmp_path / "encoders.pt"
    encoders.save(path, "abc")
    with pytest.raises(SagError, match="skeleton 'gta_im_19', not 'prox_16'"):
        MotionEncoders.load(path, skeleton="prox_16")
    with pytest.raises(SagError, match="fingerprint 'abc', not 'xyz'"):
        MotionEncoders.load(path, fingerprint="xyz")
    with pytest.raises(SagError, match=r"none\.pt are missing; train them with sag"):
        MotionEncoders.load(tmp_path / "none.pt")
