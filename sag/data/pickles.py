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

SIZE_LIMIT = 64 << 20
"""Largest pickle that is read unless told otherwise, bytes: GTA-IM's longest recordings have about 10,000 frames, and
each tells 98 bones by name and place in 3 to 5 KB."""


def load_pickle(path: Path, limit: int = SIZE_LIMIT) -> Any:
    """Content of a pickle of plain types and numpy arrays (numbers and text, no objects).

    Args:
        path: file of any pickle protocol; Python 2's strings are read as latin1.
        limit: largest size that is read, bytes. In memory it may become sixteen times as much, see `Budget`.

    Raises:
        SagError: the file is missing, larger or damaged, takes far more memory than numbers do, or names anything else;
            the sentence holds the name.
    """
    content = read_file(path, limit)
    try:
        reader = _PlainUnpickler(content)
        return _resolved(reader.load(), {}, reader.budget)
    except ForbiddenError as error:
        raise SagError(
            f"{path} is refused because it names {_short(error)}: only plain types and numpy arrays are read; "
            "replace it by the original file"
        ) from error
    except Exception as error:  # a damaged pickle can raise anything
        said = _short(error) or type(error).__name__
        raise SagError(f"{path} cannot be read as a pickle ({said}); replace it by the original file") from error


def _short(error: Exception) -> str:
    """What an error says, which may be as long as the file."""
    return " ".join(str(error)[:200].split())


_POINTER = 8
"""Bytes of whatever is put on the stack."""

_COSTS = {
    40: (pickle.INT, pickle.BININT, pickle.BININT2, pickle.LONG, pickle.LONG1, pickle.FLOAT, pickle.BINFLOAT),
    64: (
        pickle.MARK, pickle.STRING, pickle.SHORT_BINSTRING, pickle.BINSTRING, pickle.SHORT_BINBYTES, pickle.BINBYTES,
        pickle.UNICODE, pickle.SHORT_BINUNICODE, pickle.BINUNICODE, pickle.LONG4, pickle.BINBYTES8, pickle.BINUNICODE8,
        pickle.BYTEARRAY8,
        pickle.EMPTY_LIST, pickle.LIST, pickle.TUPLE, pickle.TUPLE1, pickle.TUPLE2, pickle.TUPLE3,
    ),
    100: (pickle.PUT, pickle.BINPUT, pickle.LONG_BINPUT, pickle.MEMOIZE),
    240: (pickle.EMPTY_DICT, pickle.DICT, pickle.EMPTY_SET, pickle.FROZENSET),
}  # fmt: skip
"""Bytes that an operation takes besides the content it holds; the others take a pointer at most."""


def _paid(load: Callable[[Any], None], cost: int) -> Callable[[Any], None]:
    """An operation whose memory is spent first."""

    def paid(reader: Any) -> None:
        reader.budget.spend(cost)
        load(reader)

    return paid


def _load_build(reader: Any) -> None:
    """The state of an array or a data type; nothing else has one."""
    owner = reader.stack[-2]
    if not isinstance(owner, Array | DataType):
        raise ForbiddenError(f"a state of a {type(owner).__name__}")
    owner.__setstate__(reader.stack.pop())


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
    known[pickle.BUILD[0]] = _load_build
    known[pickle.SETITEM[0]] = _with_keys(known[pickle.SETITEM[0]], lambda reader: reader.stack[-2:-1])
    for code in (pickle.SETITEMS, pickle.DICT):
        known[code[0]] = _with_keys(known[code[0]], lambda reader: reader.stack[::2])
    for code in (pickle.ADDITEMS, pickle.FROZENSET):
        known[code[0]] = _with_keys(known[code[0]], lambda reader: reader.stack)
    costs = {code[0]: cost for cost, codes in _COSTS.items() for code in codes}
    return {code: _paid(load, costs.get(code, _POINTER)) for code, load in known.items()}


# The implementation in C sets memory aside for whatever place and length a file claims; this one does not.
class _PlainUnpickler(pickle._Unpickler):
    """Reads from memory, so that no length in the file asks for more than the file holds."""

    dispatch = _operations()

    def __init__(self, content: bytes) -> None:
        super().__init__(io.BytesIO(content), encoding="latin1")
        self.budget = Budget(len(content))
        self._known = stand_ins(self.budget)

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) not in self._known:
            raise ForbiddenError(f"{module}.{name}")
        return self._known[module, name]


_HOLDERS = (list, dict, tuple, Array, StandIn, DataType)
"""What can hold a stand-in or be one."""

_RESOLVED = 160
"""Bytes of what is known of one that is resolved."""


def _resolved(value: Any, done: dict[int, tuple[Any, Any]], budget: Budget) -> Any:
    """The value with arrays in place of their stand-ins; what is shared is resolved once.

    Args:
        value: part of what the pickle made.
        done: by identity, what was there (kept alive, so that no identity is used twice) and what it became.
        budget: of memory.
    """
    if not isinstance(value, _HOLDERS):
        return value
    if id(value) in done:
        return done[id(value)][1]
    budget.spend(_RESOLVED)
    done[id(value)] = (value, value)
    if isinstance(value, list):
        value[:] = [_resolved(v, done, budget) for v in value]
    elif isinstance(value, dict):
        value.update({k: _resolved(v, done, budget) for k, v in value.items()})
    elif isinstance(value, tuple):
        done[id(value)] = (value, tuple(_resolved(v, done, budget) for v in value))
    elif isinstance(value, Array):
        done[id(value)] = (value, value.value)
    else:
        raise ForbiddenError("a type as a value")
    return done[id(value)][1]
