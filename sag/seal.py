"""Archives that know their checksum, so that no bit of them can change unnoticed.

PyTorch writes ZIP archives, and reads them with a flipped bit as if nothing were wrong. A sealed archive ends in
ZIP's own comment, `sag sha256 <digest>`, over every byte before it: one file, which every reader of ZIP still reads.
"""

from __future__ import annotations

import hashlib
import struct
from io import BytesIO
from pathlib import Path

from sag.errors import Damaged
from sag.files import write_whole

MARK = b"sag sha256 "
LENGTH = len(MARK) + 2 * hashlib.sha256().digest_size

END = b"PK\x05\x06"
"""What ZIP's last record begins with; its last two bytes are the length of the comment after it."""

END_LENGTH = 22


def write_sealed(path: Path, archive: BytesIO, keep: Path | None = None) -> None:
    """Writes an archive with its checksum, whole or not at all.

    Args:
        path: the file.
        archive: a ZIP without a comment, as `torch.save` makes it; its last two bytes are changed.
        keep: name in the same folder under which a file that is replaced stays.
    """
    content = archive.getbuffer()
    content[-2:] = struct.pack("<H", LENGTH)
    seal = MARK + hashlib.sha256(content).hexdigest().encode()
    write_whole(path, lambda file: (file.write(content), file.write(seal)), keep)


def read_sealed(path: Path) -> tuple[BytesIO, bool]:
    """An archive, and whether it was sealed: those of earlier versions are not.

    Raises:
        Damaged: it is not as it was written, by a single bit or by its missing end.
        OSError: it cannot be read at all.
    """
    content = path.read_bytes()
    if content[-END_LENGTH:].startswith(END) and content.endswith(b"\0\0"):
        return BytesIO(content), False
    body, seal = memoryview(content)[:-LENGTH], content[-LENGTH:]
    if not seal.startswith(MARK) or len(seal) < LENGTH:
        raise Damaged(f"{path} has no checksum at its end, so it was cut short or is no checkpoint of this program")
    if seal != MARK + hashlib.sha256(body).hexdigest().encode():
        raise Damaged(f"{path} is not as it was written: its checksum differs")
    return BytesIO(content), True
