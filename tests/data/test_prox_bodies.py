import os
import pickle
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from prox_files import Take, body, fit
from prox_models import write_model

from sag.data.prox import bodies
from sag.data.prox.bodies import read_model
from sag.data.prox.fits import SMPLX_JOINTS, Bodies
from sag.errors import SagError
from sag.skeleton import PROX_16


class Gadget:
    def __init__(self, canary: Path):
        self.canary = canary

    def __reduce__(self):
        return os.mkdir, (str(self.canary),)


@pytest.fixture(scope="module")
def model(tmp_path_factory) -> Path:
    """A file of SMPL-X's layout, whose joints at rest are those of `body()`."""
    return write_model(tmp_path_factory.mktemp("models") / "SMPLX_MALE.npz")


def test_smplx_is_given_a_model_without_objects(model, monkeypatch):
    given = {}

    def create(path: str, **_: object) -> None:
        with np.load(path, allow_pickle=False) as file:
            given.update({name: file[name].shape for name in file.files})
        raise ValueError(str(Path(path).name))

    monkeypatch.setitem(sys.modules, "smplx", SimpleNamespace(create=create))
    with pytest.raises(SagError, match=r"by smplx \(SMPLX_MALE\.npz\)"):
        bodies.body_of(model.parent, "male", 12)
    assert given["J_regressor"] == (55, 10_475) and given["posedirs"] == (10_475, 3, 486)
    assert set(given) == {*bodies.NUMBERS, *bodies.PLACES}


@pytest.mark.parametrize("name", ["v_template", "f"])
def test_models_that_would_run_something_are_not_run(tmp_path, name):
    hostile = np.array([Gadget(tmp_path / "canary")], object)
    path = write_model(tmp_path / "SMPLX_MALE.npz", **{name: hostile, "part2num": hostile})
    with pytest.raises(SagError, match=rf"SMPLX_MALE\.npz .*{name} .*take the model of SMPL-X as \.npz"):
        read_model(path)
    assert not (tmp_path / "canary").exists()


@pytest.mark.parametrize(
    "changes",
    [
        {"weights": None},
        {"J_regressor": np.eye(24, 6890)},
        {"hands_meanl": np.full(45, np.nan)},
        {"f": np.full((20_908, 3), 10_475)},
        {"lmk_faces_idx": np.full(51, -1)},
        {"kintree_table": np.full((2, 55), 55)},
    ],
)
def test_models_of_another_layout_are_refused(tmp_path, changes):
    path = write_model(tmp_path / "SMPLX_MALE.npz", **changes)
    with pytest.raises(SagError, match=rf"SMPLX_MALE\.npz .*{next(iter(changes))}"):
        read_model(path)


def test_the_real_smplx_moves_a_model_of_its_layout(model, tmp_path):
    pytest.importorskip("smplx", reason="the package smplx is not installed")
    turned = {"global_orient": [[0, np.pi, 0]], "betas": [[2.0, *(0,) * 9]], "left_hand_pose": np.ones((1, 12))}
    bent = np.zeros((1, 63))
    bent[0, 3 * SMPLX_JOINTS["left_elbow"] - 3 :][:3] = [0, 0, np.pi / 2]
    paths = []
    for name, changes in (("rest", {}), ("turned", turned), ("bent", {"body_pose": bent})):
        paths.append(tmp_path / f"{name}.pkl")
        content = {**fit(Take().joints[0]), **changes}
        paths[-1].write_bytes(pickle.dumps({name: np.asarray(value) for name, value in content.items()}, protocol=2))
    rest, other, elbow = Bodies(model.parent, ()).joints(paths, female=False) - Take().roots[0]
    np.testing.assert_allclose(rest, body(), atol=1e-5)
    np.testing.assert_allclose(other, body() * [-1, 1, -1] + [0, 0.25, 0], atol=1e-5)
    upper, lower = (rest[PROX_16.index("left_wrist")] - rest[PROX_16.index("left_elbow")])[0][:2]
    moved = rest.copy()
    moved[PROX_16.index("left_wrist")] = rest[PROX_16.index("left_elbow")] + [-lower, upper, 0]
    np.testing.assert_allclose(elbow, moved, atol=1e-5)


def test_a_model_that_the_real_smplx_cannot_move_is_refused(tmp_path):
    pytest.importorskip("smplx", reason="the package smplx is not installed")
    write_model(tmp_path / "SMPLX_MALE.npz", kintree_table=np.full((2, 55), 54))
    (tmp_path / "000.pkl").write_bytes(pickle.dumps(fit(body()), protocol=2))
    with pytest.raises(SagError, match=r"SMPLX_MALE\.npz makes no bodies by smplx"):
        Bodies(tmp_path, ()).joints([tmp_path / "000.pkl"], female=False)
