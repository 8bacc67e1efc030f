"""Pickles that are read without running anything they name.

A pickle is a program: it may call whatever it can import. Here the few names that numpy arrays are made
of lead to stand-ins that only remember what they were given, and every other name is refused.
"""

from __future__ import annotations

import pickle
import re
from collections import OrderedDict
from pathlib import Path
from typing import Any

import numpy as np

from sag.errors import SagError

PLAIN: dict[tuple[str, str], Any] = {
    ("collections", "OrderedDict"): OrderedDict,
    **{(b, t.__name__): t for b in ("builtins", "__builtin__") for t in (set, frozenset, complex)},
}
"""Plain types that pickles import by name."""


def load_pickle(path: Path) -> Any:
    """Content of a pickle of plain types and numpy arrays (numbers and text, no objects).

    Args:
        path: file of any pickle protocol; Python 2's strings are read as latin1.

    Raises:
        SagError: the file is missing or damaged, or names anything else; the sentence holds the name.
    """
    try:
        with path.open("rb") as file:
            return _resolved(_PlainUnpickler(file, encoding="latin1").load(), {})
    except _ForbiddenError as error:
        raise SagError(
            f"{path} is refused because it names {error}: only plain types and numpy arrays are read; "
            "replace it by the original file"
        ) from error
    except Exception as error:  # a damaged pickle can raise anything
        raise SagError(f"{path} cannot be read as a pickle ({error}); replace it by the original file") from error


class _ForbiddenError(Exception):
    """The name of something that a pickle may not use."""


class _PlainUnpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        for known in (PLAIN, _STAND_INS):
            if (module, name) in known:
                return known[module, name]
        raise _ForbiddenError(f"{module}.{name}")


class _DataType:
    """Remembers a numpy data type; `numpy.dtype` itself would let a pickle forge one that holds pointers."""

    __slots__ = ("code", "order")

    def __init__(self, code: str, align: Any = False, copy: Any = False) -> None:
        if not re.fullmatch(r"[biufcSU]\d{1,6}", code):
            raise _ForbiddenError(f"numpy data type {code}")
        self.code = code
        self.order = "="

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _, order, subarray, names, fields, *_ = state
        if order not in ("<", ">", "=", "|") or (subarray, names, fields) != (None, None, None):
            raise _ForbiddenError("a numpy data type of several fields")
        self.order = order

    @property
    def real(self) -> np.dtype:
        return np.dtype(self.order + self.code)


class _Array:
    """Remembers a numpy array until the pickle has ended."""

    __slots__ = ("value",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self) -> None:
        self.value = np.empty(0)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _, shape, dtype, fortran, content = state
        if not isinstance(dtype, _DataType) or not isinstance(content, bytes | bytearray | str):
            raise _ForbiddenError("a numpy array of objects")
        raw = content.encode("latin1") if isinstance(content, str) else bytes(content)
        self.value = np.ndarray(shape, dtype.real, raw, order="F" if fortran else "C").copy()


class _StandIn:
    """Something callable whose attributes a pickle cannot set."""

    __slots__ = ()


class _Reconstruct(_StandIn):
    """For `_reconstruct(ndarray, (0,), b"b")`: an array whose state follows."""

    __slots__ = ()

    def __call__(self, kind: Any, shape: Any, code: Any) -> _Array:
        return _Array()


class _FromBuffer(_StandIn):
    """For `_frombuffer(content, dtype, shape, order)`, an array in protocol 5."""

    __slots__ = ()

    def __call__(self, content: Any, dtype: Any, shape: Any, order: str) -> _Array:
        array = _Array()
        array.__setstate__((1, shape, dtype, order == "F", content))
        return array


class _Scalar(_StandIn):
    """For `scalar(dtype, content)`, a numpy number."""

    __slots__ = ()

    def __call__(self, dtype: Any, content: Any) -> Any:
        return _FromBuffer()(content, dtype, (), "C").value[()]


class _Encode(_StandIn):
    """For `_codecs.encode(text, "latin1")`, by which protocols before 3 write bytes."""

    __slots__ = ()

    def __call__(self, text: str, encoding: str) -> bytes:
        if encoding != "latin1":
            raise _ForbiddenError(f"the codec {encoding}")
        return text.encode("latin1")


class _NoBytes(_StandIn):
    """For `bytes()`, by which protocols before 3 write empty bytes."""

    __slots__ = ()

    def __call__(self) -> bytes:
        return b""


_NUMPY_STAND_INS: dict[tuple[str, str], Any] = {
    ("multiarray", "_reconstruct"): _Reconstruct(),
    ("multiarray", "scalar"): _Scalar(),
    ("numeric", "_frombuffer"): _FromBuffer(),
}

_STAND_INS: dict[tuple[str, str], Any] = {
    ("numpy", "ndarray"): _StandIn(),
    ("numpy", "dtype"): _DataType,
    ("_codecs", "encode"): _Encode(),
    ("builtins", "bytes"): _NoBytes(),
    ("__builtin__", "bytes"): _NoBytes(),
    **{(f"numpy.{c}.{m}", n): v for c in ("core", "_core") for (m, n), v in _NUMPY_STAND_INS.items()},
}


_HOLDERS = (list, dict, tuple, _Array, _StandIn, _DataType, type)
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
    elif isinstance(value, _Array):
        done[id(value)] = (value, value.value)
    else:
        raise _ForbiddenError("a type as a value")
    return done[id(value)][1]
