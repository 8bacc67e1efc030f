"""The data module of a folder of one's own."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

from sag.data.folder.files import GUIDE, MOTION, SKELETON, Head, read_head
from sag.data.folder.pictures import Pictures
from sag.data.folder.reader import events, stored_window, usable_starts
from sag.data.folder.recording import Recording, recordings_in
from sag.data.folder.split import NamedRooms, in_order
from sag.data.paths import regular
from sag.data.recordings import Limits, Reader, RecordedDataModule
from sag.data.recordings.digest import digest_of
from sag.errors import SagError
from sag.skeleton import Skeleton, read_skeleton

DEFAULT_LIMITS = Limits()
"""What a window must keep to when a config says nothing."""


class FolderDataModule(RecordedDataModule):
    """A folder of one's own: windows of its recordings, converted once to a window cache.

    Args:
        root: folder that holds `skeleton.yaml` and a folder for each recording, see `docs/own-data.md`.
        skeleton: the folder's `skeleton.yaml`, or the name or file of another whose joints are among its; empty
            stands for `skeleton.yaml`, but methods do not know the folder and have to be told.
        stride: frames from one window to the next (paper, 4.1).
        train_rooms: rooms to train on; all that do not test where none is told.
        test_rooms: rooms to test on; all that do not train, or the last 30 % of the names, where none is told.
        shared_test_share: share of the recordings that test of a room in both.
        val_share: share of the training recordings that are held out.
        limits: what a window must keep to.
        cloud_step: of the native depth every so many rows and columns go to the test windows' clouds.
        skip_broken: leaves recordings out that cannot be read, with a note that names each; otherwise they are errors.
        ankle_height: height of a standing person's ankle joint over the floor, metres.
        cache_dir: folder that holds the window caches.
        image_size: rows and columns of the picture; the paper's is 288 x 512.
        batch_size: windows of a training step.
        eval_batch_size: windows of a validation or test step.
    """

    name = "folder"
    version = 1
    needs = "65 frames, the first with colour and depth"

    def __init__(
        self,
        root: Path,
        skeleton: str = "",
        stride: int = 5,
        train_rooms: tuple[int | str, ...] = (),
        test_rooms: tuple[int | str, ...] = (),
        shared_test_share: float = 0.5,
        val_share: float = 0.05,
        limits: Limits = DEFAULT_LIMITS,
        cloud_step: int = 1,
        skip_broken: bool = False,
        ankle_height: float = 0.085,
        cache_dir: Path = Path("data"),
        image_size: tuple[int, int] = (288, 512),
        batch_size: int = 16,
        eval_batch_size: int = 64,
    ) -> None:
        told = Path(root) / SKELETON
        if not told.exists():
            raise SagError(f"{root} has no {SKELETON}; set the data set's folder by --data.init_args.root; {GUIDE}")
        self.told: Skeleton = read_skeleton(regular(told))
        rooms = NamedRooms(tuple(map(str, train_rooms)), tuple(map(str, test_rooms)), shared_test_share, val_share)
        super().__init__(
            root, stride, rooms, limits, cloud_step, skip_broken,
            cache_dir, skeleton or str(told), image_size, batch_size, eval_batch_size,
        )  # fmt: skip
        self.ankle_height = ankle_height

    def joint_places(self) -> list[int]:
        """Places of the skeleton's joints among those of the files."""
        if missing := sorted(set(self.skeleton.joints) - set(self.told.joints)):
            raise SagError(
                f"skeleton {self.skeleton.name} has joints that {self.told.path} lacks: {', '.join(missing)}"
            )
        return self.told.index(*self.skeleton.joints)

    @cached_property
    def heads(self) -> dict[str, Head]:
        """Frames a second and room of the recordings that tell them, by name, in order."""
        found = {}
        for folder in self.recordings():
            try:
                found[folder.name] = read_head(folder / MOTION)
            except SagError:
                continue  # reading the recording says what is wrong with it
        return found

    @cached_property
    def reader(self) -> Reader:
        """How its recordings are read."""
        rooms = in_order({head.room for head in self.heads.values()})
        return Reader(self.name, self._read, usable_starts, stored_window, rooms=rooms, events=events)

    def _read(self, folder: Path) -> Recording:
        recording = Recording.read(folder, self.told)
        if recording.head.fps != self.native_fps():
            raise SagError(
                f"{folder / MOTION} tells fps {recording.head.fps:g}, unlike {next(iter(self.heads))} with "
                f"{self.native_fps():g}: resample one of them, or keep them in two data sets"
            )
        return recording

    def recordings(self) -> list[Path]:
        """Folders of the recordings."""
        found = list(recordings_in(self.root))
        if not found:
            raise SagError(f"{self.root} holds no recording: a folder with {MOTION} and pictures; {GUIDE}")
        return found

    def sources(self) -> dict[str, Any]:
        """What the joints of the files are, and the files by name, size and time."""
        return {"told": self.told.description, "files": digest_of(self.recordings())}

    def native_fps(self) -> float:
        """Frames a second of the first recording that tells them, which are those of all."""
        return next((head.fps for head in self.heads.values()), 0.0)

    def remarks(self) -> list[str]:
        """How many recordings do not tell, by pictures of all frames that windows start in, where the person is."""
        told = [_tells_person(Pictures(folder)) for folder in self.recordings()]
        counts = {
            "recordings have no picture of where the person is": sum(not any(frames) for frames in told),
            "recordings have pictures of where the person is in some frames only": sum(
                any(frames) and not all(frames) for frames in told
            ),
        }
        sought = "there it is sought by the bones, and what is missed of it counts as scene"
        return [f"{count} {without}; {sought}" for without, count in counts.items() if count]


def _tells_person(pictures: Pictures) -> list[bool]:
    """For each frame with colour and depth, whether a picture tells where the person is."""
    return [pictures.tells_person(frame) for frame in pictures.complete]
