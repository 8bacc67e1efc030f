"""Damaged and hostile files are refused in one line that names them; nothing is run, and memory stays small."""

import pickle
import shutil
from pathlib import Path

import hostile_files as bad
import hostile_traps as trap
import numpy as np
import pytest
from gta_im_files import Sequence, module
from hostile_cases import ARCHIVES, CASES, PICKLES, ROOMS
from hostile_files import COLOUR, DEPTH, IDS, NPZ, PICKLE, ROOM
from hostile_memory import little_memory

from sag.data.gta_im.bones import BONES, cameras_of, joints_of
from sag.data.gta_im.files import clips_of, read_frames
from sag.data.gta_im.recording import Recording
from sag.errors import SagError


@pytest.fixture(scope="session")
def whole(tmp_path_factory) -> Path:
    """A recording of one window; read once, so that what reading needs is there."""
    root = tmp_path_factory.mktemp("whole")
    folder = Sequence(65).write(root / "FPS-30" / "rec", pictured=[0])
    module(root, root / "cache").build()
    return folder


def damaged(whole: Path, tmp_path: Path, damage: bad.Damage, name: str = "rec") -> Path:
    """A copy of the recording after the damage; the root is `tmp_path / "root"`."""
    folder = shutil.copytree(whole, tmp_path / "root" / "FPS-30" / name)
    damage(folder)
    return tmp_path / "root"


def refusal(root: Path, tmp_path: Path) -> str:
    """The error of reading a data set, which takes little memory."""
    with little_memory(), pytest.raises(SagError) as error:
        module(root, tmp_path / "cache").build()
    return str(error.value)


@pytest.mark.parametrize(("damage", "file"), CASES)
def test_refused_by_name_in_one_line(whole, tmp_path, damage, file):
    message = refusal(damaged(whole, tmp_path, damage), tmp_path)
    assert file in message and "\n" not in message
    assert not (tmp_path / "canary").exists()
    assert not (tmp_path / "cache").exists() or not any((tmp_path / "cache").iterdir())


def test_there_are_ten_gadgets_and_more_than_forty_cases():
    assert len(trap.gadgets()) == 10 and len(CASES) > 40


@pytest.mark.parametrize("name", ["会議室", "видео", "غرفة", "e\u0301te\u0301 2020", "🙂"])
def test_names_in_other_scripts_are_read_and_told(whole, tmp_path, name):
    root = damaged(whole, tmp_path, lambda folder: None, name)
    assert len(module(root, tmp_path / "cache").build()) == 3
    bad.truncated(NPZ)(root / "FPS-30" / name)
    assert name in refusal(root, tmp_path)


def test_a_recording_of_64_frames_is_refused(tmp_path):
    Sequence(64).write(tmp_path / "root" / "FPS-30" / "short", pictured=[0])
    message = refusal(tmp_path / "root", tmp_path)
    assert "short" in message and "fewer than 65 frames" in message


def test_what_is_not_asked_for_in_an_archive_is_not_unpacked(whole, tmp_path):
    root = damaged(whole, tmp_path, bad.member("junk", bytes(64 << 20)))
    with little_memory():
        assert len(Recording.read(root / "FPS-30" / "rec")) == 65


@pytest.mark.parametrize(
    "damage",
    [
        ARCHIVES["truncated"],
        ARCHIVES["bomb"],
        ARCHIVES["nan_focal_length"],
        PICKLES["gadget_system"],
        PICKLES["link_out"],
        ROOMS["missing"],
        bad.linked_folder,
    ],
)
def test_good_recordings_beside_a_broken_one_load_when_asked(whole, tmp_path, damage, capsys):
    root = damaged(whole, tmp_path, damage)
    for name in ("good", "other"):
        shutil.copytree(whole, root / "FPS-30" / name)
    assert "rec" in refusal(root, tmp_path)
    cache = module(root, tmp_path / "cache", skip_broken=True).build()
    assert cache.index["sequences"] == ["good", "other"] and cache.index["dropped"] == {"broken recording": 1}
    assert any(note.startswith("rec LEFT OUT, it is broken: ") for note in cache.index["notes"])
    assert "rec LEFT OUT" in capsys.readouterr().out
    assert not (tmp_path / "canary").exists()


def test_nothing_is_left_when_all_recordings_are_broken(whole, tmp_path):
    root = damaged(whole, tmp_path, ARCHIVES["truncated"])
    with pytest.raises(SagError, match=r"all 1 recordings are broken, the first: rec .*info_frames\.npz"):
        module(root, tmp_path / "cache", skip_broken=True).build()


@pytest.mark.parametrize("file", [NPZ, PICKLE, ROOM, COLOUR, DEPTH, IDS])
def test_whatever_bit_is_flipped_reading_ends_in_a_value_or_an_error_that_names_the_file(whole, tmp_path, file):
    root = damaged(whole, tmp_path, lambda folder: None)
    path, random = root / "FPS-30" / "rec" / file, np.random.default_rng(0)
    original = path.read_bytes()
    refused = 0
    for _ in range(20):
        content = bytearray(original)
        content[random.integers(len(content))] ^= 1 << random.integers(8)
        path.write_bytes(content)
        try:
            Recording.read(path.parent).picture(0)
        except SagError as error:
            refused += 1
            assert "rec" in str(error) and "\n" not in str(error)
    assert refused > 12 or file not in (NPZ, DEPTH, IDS)


def real_like() -> bytes:
    """A pickle such as GTA-IM's: 98 bones by name, in another order in each frame, and its camera."""
    random = np.random.default_rng(0)
    names = [*BONES, *(f"IK_{number}" for number in range(98 - len(BONES)))]
    frames = [
        {
            "time": f"{frame:05d}",
            "cam_near_clip": 0.1,
            "cam_far_clip": 800.0,
            "cam_field_of_view": 50.0,
            "cam_pos": [-300.0 + 0.01 * frame, 500.0, 40.0],
            "cam_rot": np.array([-5.0, 0.0, 0.1 * frame]),
            "kpname": [names[bone] for bone in random.permutation(98)],
            "kpvalue": random.normal(0, 1, 294).tolist(),
        }
        for frame in range(2)
    ]
    return pickle.dumps(frames)


def test_whatever_bytes_of_a_pickle_change_it_is_read_or_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where code that ran would most likely leave something
    path, original, random = tmp_path / PICKLE, real_like(), np.random.default_rng(0)
    read = 0
    for attempt in range(300):
        content, flips = np.frombuffer(original, np.uint8).copy(), 1 + attempt % 3
        content[random.integers(len(content), size=flips)] ^= random.integers(1, 256, flips, np.uint8)
        path.write_bytes(content)
        try:
            frames = read_frames(path)
            shapes = (
                clips_of(frames, path).shape,
                joints_of(frames, path).shape,
                cameras_of(frames, (9, 16), path)[1].shape,
            )
            assert shapes == ((len(frames), 2), (len(frames), 21, 3), (len(frames), 3, 3))
            read += 1
        except SagError as error:
            assert PICKLE in str(error) and "\n" not in str(error)
    assert 0 < read < 300 and [file.name for file in tmp_path.iterdir()] == [PICKLE]
