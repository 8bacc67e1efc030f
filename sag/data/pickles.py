"""Pickles that are read without running anything they name.

A pickle is a program: it may call whatever it can import. Here the few names that numpy arrays are made
of lead to stand-ins that only remember what they were given, and every other name is refused.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sag.data.paths import read_file
from sag.data.stand_ins import Array, Budget, DataType, ForbiddenError, StandIn, hashable, stand_ins
from sag.errors import SagError

SIZE_LIMIT = 1 << 30
"""Largest pickle that is read, bytes."""


def load_pickle(path: Path) -> Any:
    """Content of a pickle of plain types and numpy arrays (numbers and text, no objects).

    Args:
        path: file of any pickle protocol; Python 2's strings are read as latin1.

    Raises:
        SagError: the file is missing or damaged, or names anything else; the sentence holds the name.
    """
    content = read_file(path, SIZE_LIMIT)
    try:
        return _resolved(_PlainUnpickler(content).load(), {})
    except ForbiddenError as error:
        raise SagError(
            f"{path} is refused because it names {error}: only plain types and numpy arrays are read; "
            "replace it by the original file"
        ) from error
    except Exception as error:  # a damaged pickle can raise anything
        said = str(error) or type(error).__name__
        raise SagError(f"{path} cannot be read as a pickle ({said}); replace it by the original file") from error


def _with_keys(load: Callable[[Any], None], keys: Callable[[Any], Any]) -> Callable[[Any], None]:
    """An operation whose keys are looked at first."""

    def checked(reader: Any) -> None:
        hashable(keys(reader))
        load(reader)

    return checked


def _load_bytearray(reader: Any) -> None:
    """An array's content in protocol 5, which is not set aside before it is there."""
    size = int.from_bytes(reader.read(8), "little")
    reader.append(bytearray(reader.read(size)))


def _operations() -> dict[int, Callable[[Any], None]]:
    """What each code of a pickle does; on the stack are the items since the last mark."""
    known: dict[int, Callable[[Any], None]] = dict(pickle._Unpickler.dispatch)
    known[pickle.BYTEARRAY8[0]] = _load_bytearray
    known[pickle.SETITEM[0]] = _with_keys(known[pickle.SETITEM[0]], lambda reader: reader.stack[-2:-1])
    for code in (pickle.SETITEMS, pickle.DICT):
        known[code[0]] = _with_keys(known[code[0]], lambda reader: reader.stack[::2])
    for code in (pickle.ADDITEMS, pickle.FROZENSET):
        known[code[0]] = _with_keys(known[code[0]], lambda reader: reader.stack)
    return known


# The implementation in C sets memory aside for whatever place and length a file claims; this one does not.
class _PlainUnpickler(pickle._Unpickler):
    """Reads from memory, so that no length in the file asks for more than the file holds."""

    dispatch = _operations()

    def __init__(self, content: bytes) -> None:
        super().__init__(io.BytesIO(content), encoding="latin1")
        self._known = stand_ins(Budget(len(content)))

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) not in self._known:
            raise ForbiddenError(f"{module}.{name}")
        return self._known[module, name]


_HOLDERS = (list, dict, tuple, Array, StandIn, DataType)
"""What can hold a stand-in or be one."""


def _resolved(value: Any, done: dict[int, tuple[Any, Any]]) -> Any:
    """The value with arrays in place of their stand-ins; what is shared is resolved once.

    Args:
        value: part of what the pickle made.
        done: by identity, what was there (kept alive, so that no identity is used twice) and what it became.
    """
    if not isinstance(value, _HOLDERS):
        return value
    if id(value) in done:
        return done[id(value)][1]
    done[id(value)] = (value, value)
    if isinstance(value, list):
        value[:] = [_resolved(v, done) for v in value]
    elif isinstance(value, dict):
        value.update({k: _resolved(v, done) for k, v in value.items()})
    elif isinstance(value, tuple):
        done[id(value)] = (value, tuple(_resolved(v, done) for v in value))
    elif isinstance(value, Array):
        done[id(value)] = (value, value.value)
    else:
        raise ForbiddenError("a type as a value")
    return done[id(value)][1]
