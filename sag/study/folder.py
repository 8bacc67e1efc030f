"""A study on disk: what raters are shown, and apart from it what only its owner may know.

public/page.html       the page, without a session
public/scenes/ID.json  a scene and its motions, under names that tell nothing
private/study.json     the key, and which motion is whose
private/answers.sqlite what raters answered
"""

from __future__ import annotations

import json
import time
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from sag.errors import SagError
from sag.study.design import Design, Item
from sag.study.tokens import Signer

FORMAT = 1
"""Of the file `study.json`."""

TRUTH = "ground_truth"
"""What the recorded motion is called among methods."""


PAUSE = 7.0
"""Seconds that a rater takes for a motion beside looking at it, as an estimate."""


@dataclass(frozen=True)
class Settings:
    """What a study is made of.

    Attributes:
        title: of the page.
        data: name of the data set.
        fingerprint: of its window cache.
        fps: frames a second.
        frames: of each motion.
        methods: names, the ground truth's among them.
        windows: of the data set, one for each scene.
        rounds: motions of each scene that a rater sees.
        repeats: motions that come again.
        sampling_seed: of the motions that were drawn.
        made: when, as ISO 8601.
        version: of sag.
    """

    title: str
    data: str
    fingerprint: str
    fps: float
    frames: int
    methods: tuple[str, ...]
    windows: tuple[int, ...]
    rounds: int
    repeats: int
    sampling_seed: int
    made: str
    version: str


@dataclass(frozen=True)
class Study:
    """A study that was made.

    Attributes:
        folder: where it lies.
        settings: what it is made of.
        key: that signs sessions and names motions.
    """

    folder: Path
    settings: Settings
    key: bytes

    @property
    def public(self) -> Path:
        """Folder of what raters are shown."""
        return self.folder / "public"

    @property
    def answers(self) -> Path:
        """File of the answers."""
        return self.folder / "private" / "answers.sqlite"

    @cached_property
    def signer(self) -> Signer:
        """What signs."""
        return Signer(self.key)

    @cached_property
    def name(self) -> str:
        """What pages call the study, to tell it from others."""
        return self.signer.identity("study")

    @cached_property
    def design(self) -> Design:
        """Who is shown what when."""
        made = self.settings
        seed = self.signer.identity("order")
        return Design(len(made.windows), len(made.methods), made.rounds, made.repeats, seed)

    @property
    def minutes(self) -> int:
        """How long a rater takes, about."""
        return max(1, round(self.design.turns * (self.settings.frames / self.settings.fps + PAUSE) / 60))

    @cached_property
    def scenes(self) -> list[str]:
        """Names of the scenes."""
        return [self.signer.identity("scene", str(place)) for place in range(len(self.settings.windows))]

    @cached_property
    def items(self) -> dict[str, Item]:
        """Which motion each name stands for."""
        made = self.settings
        every = [Item(scene, method) for scene in range(len(made.windows)) for method in range(len(made.methods))]
        return {self.item_name(item): item for item in every}

    def item_name(self, item: Item) -> str:
        """What pages call a motion."""
        return self.signer.identity("motion", str(item.scene), str(item.method))

    def session(self, number: int) -> list[str]:
        """Names of the motions that a rater is shown, in order.

        Args:
            number: of the rater.
        """
        return [self.item_name(item) for item in self.design.session(number)]


def now() -> str:
    """The time as ISO 8601, to the second, in UTC."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())


def read_study(folder: Path) -> Study:
    """The study in a folder.

    Raises:
        SagError: there is none, or its private file is damaged or of another version.
    """
    path = folder / "private" / "study.json"
    if not path.is_file():
        raise SagError(f"{folder} holds no study (private/study.json); make one by sag study make ... --out {folder}")
    try:
        content: dict[str, Any] = json.loads(path.read_text())
        found = content.pop("format")
        if found != FORMAT:
            raise SagError(f"{path} is of format {found}, this sag reads {FORMAT}; use the sag that made the study")
        key = bytes.fromhex(content.pop("key"))
        content |= {name: tuple(content[name]) for name in ("methods", "windows")}
        return Study(folder, Settings(**content), key)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise SagError(
            f"{path} cannot be read ({error!r}); restore it, since without it answers tell nothing"
        ) from error
