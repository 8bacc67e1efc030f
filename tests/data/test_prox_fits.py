import os
import pickle
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from prox_files import StandIn, Take, body, fit, form, module, write_root

from sag.data.prox import bodies, fits
from sag.data.prox.filters import NO_BODY, usable_starts
from sag.data.prox.fits import SMPLX_JOINTS, Bodies, read_fit
from sag.data.prox.recording import Recording
from sag.data.prox.root import Root
from sag.errors import SagError
from sag.skeleton import PROX_16

NAME = "MPH16_00157_01"


@pytest.fixture
def root(tmp_path) -> Path:
    return write_root(tmp_path / "root", ("MPH16",))


@pytest.fixture
def models(tmp_path, monkeypatch) -> tuple[Path, StandIn]:
    """A folder with files named as SMPL-X's models, and a stand-in that reads them."""
    stand_in = StandIn()
    monkeypatch.setitem(sys.modules, "smplx", stand_in)
    monkeypatch.setattr(bodies, "read_model", lambda path: {})
    (tmp_path / "models" / "smplx").mkdir(parents=True)
    for gender in ("MALE", "FEMALE"):
        (tmp_path / "models" / "smplx" / f"SMPLX_{gender}.npz").touch()
    return tmp_path / "models", stand_in


def read(root: Path, bodies: Bodies) -> Recording:
    return Root(root, bodies, "scan").read(root / "recordings" / NAME)


# --- its numbers ---


def test_fits_move_by_smplx(root, models):
    take = Take()
    take.write(root, NAME, fits=True)
    recording = read(root, Bodies(models[0], (162,)))
    np.testing.assert_allclose(recording.joints, take.joints, atol=1e-6)
    assert models[1].created == ["male"]


def test_the_numbers_of_smplxs_joints():
    wanted = [15, 12, 17, 19, 21, 16, 18, 20, 9, 0, 2, 5, 8, 1, 4, 7]
    assert [SMPLX_JOINTS[name] for name in PROX_16.joints] == wanted


def test_some_subjects_are_female(root, models):
    Take().write(root, NAME, fits=True)
    joints = read(root, Bodies(models[0], (157,))).joints
    assert models[1].created == ["female"]
    np.testing.assert_allclose(joints[0] - joints[0, 9], 1.1 * body(), atol=1e-6)


def test_a_data_set_moves_by_fits_when_models_are_given(root, models, tmp_path):
    Take().write(root, NAME, fits=True)
    data = module(root, tmp_path, smplx_models=models[0])
    assert len(data.build()) == 18
    assert not any("KINECT" in note for note in data.cache.index["notes"])


def test_many_fits_are_made_in_parts(root, models, monkeypatch):
    monkeypatch.setattr(fits, "TOGETHER", 32)
    take = Take()
    take.write(root, NAME, fits=True)
    np.testing.assert_allclose(read(root, Bodies(models[0], ())).joints, take.joints, atol=1e-6)


@pytest.mark.parametrize("gender", ["MALE", "FEMALE"])
def test_another_model_is_another_cache(root, models, tmp_path, gender):
    Take().write(root, NAME, fits=True)
    first = module(root, tmp_path, smplx_models=models[0]).sources()
    assert module(root, tmp_path, smplx_models=models[0]).sources() == first
    (models[0] / "smplx" / "SMPLX_NEUTRAL.npz").write_bytes(b"which nobody is fitted with")
    assert module(root, tmp_path, smplx_models=models[0]).sources() == first
    (models[0] / "smplx" / f"SMPLX_{gender}.npz").write_bytes(b"another")
    assert module(root, tmp_path, smplx_models=models[0]).sources() != first


def test_missing_fits_drop_the_windows_that_need_them(root, models):
    take = Take()
    take.write(root, NAME, fits=True)
    (root / "PROXD" / NAME / "results" / take.names[2] / "000.pkl").unlink()
    starts = usable_starts(read(root, Bodies(models[0], ())), 1, form())
    assert starts == ([3, 4, 5], Counter({NO_BODY: 3}))


# --- it refuses ---


def test_no_fits_at_all_name_the_way_out(root, models, tmp_path):
    Take().write(root, NAME)
    with pytest.raises(SagError, match=r"PROXD is missing: .*leave out --data\.init_args\.smplx_models"):
        module(root, tmp_path, smplx_models=models[0]).build()


def test_smplx_that_is_not_installed_names_the_way_out(root, models, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "smplx", None)
    Take().write(root, NAME, fits=True)
    with pytest.raises(SagError, match=r'pip install "sag\[prox\]"'):
        module(root, tmp_path, smplx_models=models[0]).build()


def test_missing_models_are_named(root, models, tmp_path):
    Take().write(root, NAME, fits=True)
    with pytest.raises(SagError, match=r"smplx_models .*elsewhere holds neither SMPLX_MALE\.npz"):
        module(root, tmp_path, smplx_models=tmp_path / "elsewhere").build()


def test_models_that_smplx_cannot_use_are_named(root, models, tmp_path, monkeypatch):
    monkeypatch.setattr(models[1], "create", lambda *_, **__: 1 / 0)
    Take().write(root, NAME, fits=True)
    with pytest.raises(SagError, match=r"SMPLX_MALE\.npz cannot be used as a model"):
        module(root, tmp_path, smplx_models=models[0]).build()


def of_shape(*shape: int) -> Callable[..., SimpleNamespace]:
    return lambda **_: SimpleNamespace(joints=torch.zeros(shape))


def mismatch(**_: object) -> None:
    raise RuntimeError("mat1 and mat2 shapes\ncannot be multiplied")


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (mismatch, r"makes no bodies by smplx \(mat1 and mat2 shapes cannot"),
        (lambda transl: None, "makes no bodies by smplx"),
        (lambda **_: None, "makes no bodies by smplx"),
        (of_shape(1, 127, 3), "makes joints of shape"),
        (of_shape(70, 16, 3), "makes joints of shape"),
        (
            lambda **_: SimpleNamespace(joints=torch.full((70, 127, 3), torch.nan)),
            "makes joints by smplx that are not finite",
        ),
    ],
)
def test_another_smplx_is_refused_in_one_line(root, models, tmp_path, monkeypatch, made, said):
    monkeypatch.setattr(models[1], "create", lambda *_, **__: SimpleNamespace(eval=lambda: made))
    Take().write(root, NAME, fits=True)
    with pytest.raises(SagError, match=rf"SMPLX_MALE\.npz {said}") as error:
        module(root, tmp_path, smplx_models=models[0]).build()
    assert "\n" not in str(error.value)


def test_pickled_models_are_refused_with_the_way_out(root, models, tmp_path):
    Take().write(root, NAME, fits=True)
    (models[0] / "smplx" / "SMPLX_MALE.npz").rename(models[0] / "smplx" / "SMPLX_MALE.pkl")
    with pytest.raises(SagError, match=r"SMPLX_MALE\.pkl is a pickle, .* take the \.npz"):
        module(root, tmp_path, smplx_models=models[0]).build()


MODELS = os.environ.get("SMPLX_MODELS")


@pytest.mark.skipif(not MODELS, reason="SMPLX_MODELS names no folder with SMPL-X's models")
def test_the_real_body_stands_upright(tmp_path):
    pytest.importorskip("smplx")
    path = tmp_path / "000.pkl"
    path.write_bytes(pickle.dumps(fit(Take().joints[0]), protocol=2))
    joints = dict(zip(PROX_16.joints, Bodies(Path(MODELS), ()).joints([path], female=False)[0]))
    assert joints["head"][1] - joints["root"][1] > 0.4 and joints["left_wrist"][0] > joints["right_wrist"][0] + 1


class Gadget:
    def __init__(self, canary: Path):
        self.canary = canary

    def __reduce__(self):
        return os.mkdir, (str(self.canary),)


def test_hostile_fits_are_refused_and_not_run(tmp_path):
    (tmp_path / "000.pkl").write_bytes(pickle.dumps({**fit(body()), "betas": Gadget(tmp_path / "canary")}))
    with pytest.raises(SagError, match=r"000\.pkl is refused because it names"):
        read_fit(tmp_path / "000.pkl")
    assert not (tmp_path / "canary").exists()


@pytest.mark.parametrize(
    "change", [{"betas": np.zeros((1, 9))}, {"transl": np.full((1, 3), np.nan)}, {"body_pose": None}, {"jaw_pose": "x"}]
)
def test_fits_of_another_layout_are_refused(tmp_path, change):
    (tmp_path / "000.pkl").write_bytes(pickle.dumps({**fit(body()), **change}, protocol=2))
    with pytest.raises(SagError, match=f"000.pkl: {next(iter(change))}"):
        read_fit(tmp_path / "000.pkl")


def test_large_fits_are_refused(tmp_path):
    (tmp_path / "000.pkl").write_bytes(pickle.dumps({**fit(body()), "more": bytes(2 << 20)}, protocol=2))
    with pytest.raises(SagError, match=r"000\.pkl is larger than the 1,048,576 bytes"):
        read_fit(tmp_path / "000.pkl")


def test_fits_without_a_part_are_refused(tmp_path):
    content = fit(body())
    del content["expression"]
    (tmp_path / "000.pkl").write_bytes(pickle.dumps(content))
    with pytest.raises(SagError, match=r"000\.pkl lacks expression"):
        read_fit(tmp_path / "000.pkl")
