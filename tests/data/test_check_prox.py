"""`sag data check` of PROX: what it counts and what it finds."""

import json

import prox_files
from check_reports import OPTIONS, told
from PIL import Image

from sag.data.check.command import main


def test_prox_is_recognised_and_told(tmp_path, capsys):
    root = prox_files.write_root(tmp_path / "root")
    for name in ("N0Sofa_00034_01", "MPH16_00157_01"):
        prox_files.Take(66).write(root, name)
    assert main([str(root), *OPTIONS, "--skeleton", "prox_16"]) == 0
    said = told(capsys)
    assert said["scenes"] == "MPH16 (1 recording), N0Sofa (1 recording)" and said["scans"] == "ok of every scene"
    assert said["frames"] == "ok 132" and said["Skeleton"] == "ok 132 files"
    assert said["bodies"].startswith("look the Kinect's skeletons") and said["bones"].startswith("ok")
    assert said["kept"].startswith("ok")


def test_what_prox_lacks_is_told(tmp_path, capsys):
    root = prox_files.write_root(tmp_path / "root")
    folder = prox_files.Take(66).write(root, "N0Sofa_00034_01")
    for path in list((folder / "Depth").iterdir())[:5]:
        path.unlink()
    (root / "cam2world" / "N0Sofa.json").unlink()
    assert main([str(root), *OPTIONS]) == 1
    said = told(capsys)
    assert "fewer than colour in 1 recording" in said["Depth"] and "61 of 66" in said["Depth"]
    assert said["cam2world"].startswith("broken missing for 1 scene ") and "N0Sofa.json" in said["broken files"]


def test_pictures_of_prox_that_are_not_mirrored_show(tmp_path, capsys):
    root = prox_files.write_root(tmp_path / "root", ("MPH16",))
    take = prox_files.Take(66)
    take.roots[:] = -0.8, 0.2, 3.0  # far enough from the middle for a mirrored person to be elsewhere
    folder = take.write(root, "MPH16_00157_01")
    assert main([str(root), *OPTIONS]) == 0
    assert told(capsys)["on person"] == "ok 100% of the joints in the picture are on the person"
    for path in (*(folder / "Color").iterdir(), *(folder / "BodyIndexColor").iterdir()):
        Image.open(path).transpose(Image.Transpose.FLIP_LEFT_RIGHT).save(path)
    assert main([str(root), *OPTIONS]) == 1
    assert told(capsys)["on person"].startswith("broken")


def test_a_camera_elsewhere_than_the_scan_has_it_shows(tmp_path, capsys):
    root = prox_files.write_root(tmp_path / "root", ("MPH16",))
    prox_files.Take(66).write(root, "MPH16_00157_01")
    moved = prox_files.CAM2WORLD.copy()
    moved[1, 3] += 2  # towards the wall, which is then before the person
    (root / "cam2world" / "MPH16.json").write_text(json.dumps(moved.tolist()))
    assert main([str(root), *OPTIONS]) == 1
    assert told(capsys)["scan"] == "broken 0% of the joints in the picture are before the scan"


def test_a_folder_of_another_name_is_told_beside_the_good_recordings(tmp_path, capsys):
    root = prox_files.write_root(tmp_path / "root", ("MPH16",))
    prox_files.Take(66).write(root, "MPH16_00157_01")
    (root / "recordings" / "holiday" / "Color").mkdir(parents=True)
    assert main([str(root), *OPTIONS]) == 1
    said = told(capsys)
    assert "recordings/holiday is not named Scene_Subject_Take" in said["broken files"]
    assert said["frames"] == "ok 66" and said["kept"].startswith("ok")
