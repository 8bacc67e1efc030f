from pathlib import Path

import numpy as np
import pytest
from gta_im_files import form
from scipy.spatial.transform import Rotation

from sag.data.check.gta_im_recording import examine
from sag.data.command import main
from sag.data.gta_im.bones import FORWARD, cameras_of
from sag.data.gta_im.reader import GTA_IM
from sag.data.gta_im.recording import ROOT, Recording
from sag.data.gta_im.views import person_id
from sag.data.recordings import filters as why
from sag.data.recordings.filters import Limits, pixels_of, root_jumps
from sag.data.recordings.plan import planned
from sag.data.recordings.splits import RoomSplit

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
def test_its_cameras_are_what_the_pickle_would_tell(original):
    """The game tells angles in float32: those that the cameras come from are such numbers, so the order is right."""
    camera = Rotation.from_matrix(original.world2cam[:, :3, :3]) * FORWARD.inv()
    angles, places = camera.as_euler("xyz", degrees=True), np.linalg.inv(original.world2cam)[:, 3, :3]
    fields = np.degrees(2 * np.arctan(540 / original.intrinsics[:, 0, 0]))
    told = [
        {"cam_pos": place, "cam_rot": angle, "cam_field_of_view": field}
        for place, angle, field in zip(*(x.astype(np.float32).astype(float) for x in (places, angles, fields)))
    ]
    world2cam, intrinsics = cameras_of(told, (1080, 1920), original.folder)
    np.testing.assert_allclose(world2cam, original.world2cam, atol=1e-9)
    published = np.load(original.folder / "info_frames.npz")["joints_2d"]
    seen = np.einsum("tji,tik->tjk", original.joints, world2cam[:, :3, :3]) + world2cam[:, 3:, :3]
    pixels = np.einsum("tji,tki->tjk", seen, intrinsics)
    assert np.abs(pixels[..., :2] / pixels[..., 2:] - published).max() < 1e-6
    assert np.abs(angles - angles.astype(np.float32)).max() < 1e-10


@real
def test_the_check_tells_what_is_known_of_it(original, tmp_path, capsys):
    found = examine(original.folder, Limits(), 3)
    assert found.projection < 1e-6 and not found.broken and not found.incomplete and not found.zooms
    assert found.jumps == [544, 581, 826, 923] and [cut.frame for cut in found.cuts] == [206, 407]
    assert [tuple(round(f) for f in cut.focal) for cut in found.cuts] == [(1158, 1484), (1484, 1158)]
    assert all(look.visible >= 10 and look.on_person >= 0.9 * look.visible for look in found.looks)
    assert main(["check", str(REAL), "--pictures", "1", "--sheet", str(tmp_path / "sheet.png"), "--count", "2"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "frames 955 " in said and "pictures 21 frames" in said and "544, 581, 826, 923" in said
    assert (
        "camera cuts 2, which drop no window; between" in said
        and "nothing is broken" in said
        and (tmp_path / "sheet.png").exists()
    )


@real
def test_the_known_teleports_are_found(original):
    assert root_jumps(original.joints[:, ROOT], Limits()) == [544, 581, 826, 923]


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
    plan = planned([original.folder], 5, form(), PAPER, GTA_IM)
    assert [w.start for w in plan.windows if w.split == "test"] == list(range(638, 659))
    assert plan.dropped == {why.NO_PICTURE: 870} and plan.size == (1080, 1920)
