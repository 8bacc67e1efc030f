"""GLB: others play the joints to a tenth of a millimetre; body, place and camera are where they were."""

import numpy as np
import pytest
import trimesh
from export_motions import PlayedGlb, rigid_motion, stretching_motion

from sag.errors import SagError
from sag.export import Upright, View, surface_of, up_of, write_glb
from sag.skeleton import GTA_IM_19, PROX_16

TENTH = 1e-4
"""Metres."""


@pytest.mark.parametrize("skeleton", [GTA_IM_19, PROX_16], ids=lambda s: s.name)
@pytest.mark.parametrize("motion", [rigid_motion, stretching_motion])
def test_joints_are_right_at_every_key(skeleton, motion, tmp_path):
    joints, path = motion(skeleton), tmp_path / "motion.glb"
    write_glb(path, joints, skeleton, 25.0)
    played = PlayedGlb(path)
    assert np.allclose(played.times, np.arange(len(joints)) / 25)
    assert np.abs(played.joints(skeleton) - joints).max() < TENTH


def test_the_body_is_around_the_bones_in_every_frame(tmp_path):
    joints, path = stretching_motion(), tmp_path / "motion.glb"
    write_glb(path, joints, GTA_IM_19, 30.0)
    body = PlayedGlb(path).body()
    starts, ends = joints[:, GTA_IM_19.bone_index[:, 0]], joints[:, GTA_IM_19.bone_index[:, 1]]
    along = ends - starts
    offset = body[:, :, None] - starts[:, None]
    share = ((offset * along[:, None]).sum(-1) / (along**2).sum(-1)[:, None]).clip(0, 1)
    distance = np.linalg.norm(offset - share[..., None] * along[:, None], axis=-1).min(axis=-1)
    assert distance.max() < 0.106  # no thicker than the head, however bones bend and stretch
    assert np.all(body.min(axis=1) < joints.min(axis=1) - 0.02) and np.all(body.max(axis=1) > joints.max(axis=1) + 0.02)
    assert np.all(body.min(axis=1) > joints.min(axis=1) - 0.11) and np.all(body.max(axis=1) < joints.max(axis=1) + 0.11)


def test_trimesh_loads_the_body_in_the_shape_of_a_t(tmp_path):
    write_glb(tmp_path / "motion.glb", rigid_motion(), GTA_IM_19, 30.0)
    (body,) = trimesh.load(tmp_path / "motion.glb").geometry.values()
    (left, down, back), (right, up, front) = body.bounds
    assert left < -0.5 and right > 0.5 and down < -0.4 < 0.4 < up and front - back < 0.3
    assert (body.face_normals * (body.triangles_center - body.center_mass)).sum(axis=1).mean() > 0  # seen from outside


def test_keys_go_the_short_way_from_one_to_the_next(tmp_path):
    write_glb(tmp_path / "motion.glb", rigid_motion(frames=40), GTA_IM_19, 30.0)
    played = PlayedGlb(tmp_path / "motion.glb")
    for channel in played.file.animations[0].channels:
        if channel.target.path == "rotation":
            keys = played.array(played.file.animations[0].samplers[channel.sampler].output)
            assert ((keys[1:] * keys[:-1]).sum(axis=1) >= 0).all()


def test_a_motion_that_stands_still_lasts_as_long_as_it_does(tmp_path):
    joints = np.repeat(rigid_motion(frames=1), 31, axis=0)
    write_glb(tmp_path / "motion.glb", joints, GTA_IM_19, 30.0)
    played = PlayedGlb(tmp_path / "motion.glb")
    assert played.times[-1] == pytest.approx(1) and len(played.file.animations[0].channels) == 2
    assert np.abs(played.joints(GTA_IM_19) - joints).max() < TENTH


@pytest.fixture
def window(toy) -> tuple[int, Upright]:
    """A test window of the toy data and its axes."""
    row = int(toy.cache.rows("test")[0])
    return row, Upright.at(toy.cache.joints[row, 0], toy.skeleton, up_of(toy.cache.world2cam[row]))


def test_the_place_is_where_the_depth_is(toy, window, tmp_path):
    row, upright = window
    surface = surface_of(toy, row)
    write_glb(tmp_path / "motion.glb", rigid_motion(), GTA_IM_19, 30.0, surface.stood_up(upright))
    mesh = trimesh.load(tmp_path / "motion.glb").geometry["scene"]
    points = upright.to_camera(np.asarray(mesh.vertices, dtype=np.float64))
    focal, (rows, columns) = 0.9 * 64, toy.image_size
    matrix = toy.cache.intrinsics[row]
    seen = points[:, :2] / points[:, 2:] * focal + matrix[:2, 2]
    expected = toy.cache.depth[row][seen[:, 1].astype(int), seen[:, 0].astype(int)] / 1000
    assert np.abs(points[:, 2] - expected).max() < 1e-3
    places = np.asarray(mesh.visual.uv) * [1, -1] + [0, 1]
    assert np.abs(places * [columns, rows] - seen).max() < 1e-3
    toward = (mesh.face_normals * (upright.from_camera(np.zeros(3)) - mesh.triangles_center)).sum(axis=1)
    assert (toward > 0).all()


def test_the_person_and_jumps_of_depth_are_no_surface(toy, window, monkeypatch):
    row, _ = window
    depth, ids = np.full((36, 64), 5000, np.uint16), np.zeros((36, 64), np.uint8)
    depth[:, 40:] = 3000
    ids[10:20, 10:14] = 255
    for name, array in (("depth", depth), ("ids", ids)):
        monkeypatch.setitem(toy.cache.__dict__, name, {row: array})
    monkeypatch.setitem(toy.cache.__dict__, "cloud_row", {row: -1})
    surface = surface_of(toy, row)
    corners = surface.points[surface.triangles]
    assert np.ptp(corners[..., 2], axis=1).max() == 0  # none from the wall to what stands before it
    pixels = (surface.places * [64, 36]).astype(int)
    assert not ids[pixels[:, 1], pixels[:, 0]].any() and len(pixels) == 36 * 64 - 40
    monkeypatch.setitem(toy.cache.__dict__, "depth", {row: 0 * depth})
    with pytest.raises(SagError, match="has no depth to make a surface of"):
        surface_of(toy, row)


def test_a_surface_at_the_papers_size_stays_small(toy, window, tmp_path, monkeypatch):
    row, upright = window
    size = (288, 512)
    picture = np.random.default_rng(0).integers(0, 255, (*size, 3), dtype=np.uint8)  # the worst that JPEG can meet
    monkeypatch.setitem(toy.cache.__dict__, "cloud_row", {row: 0})
    monkeypatch.setitem(toy.cache.__dict__, "cloud_depth", np.full((1, *size), 4000, np.uint16))
    monkeypatch.setitem(
        toy.cache.__dict__, "cloud_intrinsics", toy.cache.intrinsics[[row]] * np.array([[8.0], [8], [1]])
    )
    monkeypatch.setattr(toy, "picture", lambda window: picture)
    write_glb(tmp_path / "motion.glb", rigid_motion(frames=65), GTA_IM_19, 30.0, surface_of(toy, row).stood_up(upright))
    assert (tmp_path / "motion.glb").stat().st_size < 3e6


def test_the_camera_looks_along_its_own_axis(tmp_path):
    turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    view = View(np.array([1.0, 2, 3]), turn, 0.8, 1.5)
    write_glb(tmp_path / "motion.glb", rigid_motion(), GTA_IM_19, 30.0, view=view)
    played = PlayedGlb(tmp_path / "motion.glb")
    lens = played.file.cameras[0].perspective
    assert (lens.yfov, lens.aspectRatio) == (0.8, 1.5)
    assert np.allclose(played.matrices[0, played.node("camera"), :3], np.column_stack([turn, view.place]))


def test_refuses_what_it_cannot_write(tmp_path):
    broken = rigid_motion()
    broken[2, 12] = np.inf
    with pytest.raises(SagError, match="root in frame 2 is at no finite place"):
        write_glb(tmp_path / "motion.glb", broken, GTA_IM_19, 30.0)
    with pytest.raises(SagError, match=r"must be a file that ends in \.glb"):
        write_glb(tmp_path / "motion.gltf", rigid_motion(), GTA_IM_19, 30.0)
    assert not list(tmp_path.iterdir())


def test_several_bodies_in_one_file_each_move_as_their_own_motion(tmp_path):
    motions = [stretching_motion(), rigid_motion() + [2, 0, 0]]
    write_glb(tmp_path / "a.glb", motions, GTA_IM_19, 30)
    played = PlayedGlb(tmp_path / "a.glb")
    skins = played.file.skins
    assert [skin.name for skin in skins] == ["person_1", "person_2"] and len(played.file.animations) == 1
    for skin, joints in zip(skins, motions):
        places = {played.file.nodes[node].name: node for node in skin.joints}
        found = played.matrices[:, [places[name] for name in GTA_IM_19.joints]][..., :3, 3]
        assert np.abs(found - joints).max() < 1e-4
    colours = [tuple(m.pbrMetallicRoughness.baseColorFactor) for m in played.file.materials]
    assert len(set(colours)) == 2
    with pytest.raises(SagError, match="joints are 18"):
        write_glb(tmp_path / "b.glb", [motions[0], motions[1][:, 1:]], GTA_IM_19, 30)
