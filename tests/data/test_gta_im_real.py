from pathlib import Path

import numpy as np
import pytest

from sag.data.gta_im import filters as why
from sag.data.gta_im.filters import Limits, pixels_of, root_jumps
from sag.data.gta_im.plan import planned
from sag.data.gta_im.recording import Recording
from sag.data.gta_im.splits import RoomSplit
from sag.data.gta_im.views import person_id

PAPER = RoomSplit((1, 2, 3, 6, 10, 11), (10, 11, 13), 0.5, 0.05)


REAL = Path(__file__).parents[2] / "../shared/data/gta-im"
real = pytest.mark.skipif(not REAL.is_dir(), reason="no recording of GTA-IM in ../shared/data/gta-im")


@pytest.fixture(scope="module")
def original() -> Recording:
    return Recording.read(next((REAL / "FPS-5").iterdir()))


@real
def test_every_frame_projects_to_the_published_2d_joints(original):
    published = np.load(original.folder / "info_frames.npz")["joints_2d"]
    seen = np.concatenate([original.seen_from(frame, slice(frame, frame + 1)) for frame in range(len(original))])
    pixels = np.concatenate([pixels_of(x, k)[None] for x, k in zip(seen, original.intrinsics)])
    assert len(published) == 955 and (seen[..., 2] > 0.1).all()
    assert np.abs(pixels - published).max() < 1e-6


@real
def test_the_known_teleports_are_found(original):
    assert root_jumps(original, Limits()) == [544, 581, 826, 923]


@real
def test_the_persons_mask_holds_most_visible_joints(original):
    for frame in (638, 648, 658):
        picture = original.picture(frame)
        joints = original.seen_from(frame, slice(frame, frame + 1))[0]
        pixels = pixels_of(joints, picture.intrinsics)
        columns, rows = pixels[why.inside_picture(pixels, 1080, 1920)].astype(int).T
        mask = picture.ids == person_id(picture, joints)
        assert len(rows) >= 15 and mask[rows, columns].mean() > 0.8
        assert 0.01 < mask.mean() < 0.25


@real
def test_the_real_recording_has_a_window_for_each_picture(original):
    plan = planned([original.folder], 5, Limits(), PAPER)
    assert [w.start for w in plan.windows if w.split == "test"] == list(range(638, 659))
    assert plan.dropped == {why.NO_PICTURE: 870} and plan.size == (1080, 1920)
