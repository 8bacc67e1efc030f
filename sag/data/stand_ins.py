"""What the names in a pickle lead to: stand-ins that remember what they were given and do nothing else."""

from __future__ import annotations

import re
from collections import OrderedDict
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

_ITEM = 128
"""Bytes of an item of a set or a dictionary."""

_ARRAY = 240
"""Bytes of an empty array, set or dictionary, and of what is remembered about it."""

LONGEST_KEY = 16
"""Most parts of a tuple that is a key; hashing a long one again and again would never end."""

KEYS = (str, bytes, int, float, complex, type(None))
"""What dictionaries may have as keys and sets may hold, beside flat tuples of them; hashing a nest of shared tuples
would never end."""


class ForbiddenError(Exception):
    """The name of something that a pickle may not use."""


class Budget:
    """Memory that a pickle may still take, bytes: without it a short file could copy one array a million times, and
    each of its bytes could be an empty list of 200.

    Args:
        size: of the file, bytes. Frames such as GTA-IM's are counted as eight times their file, with small arrays in
            them as twelve times; small files may do as they like.
    """

    def __init__(self, size: int) -> None:
        self.left = (16 << 20) + 16 * size

    def spend(self, count: int) -> None:
        """Takes some bytes.

        Raises:
            ForbiddenError: there are no more.
        """
        self.left -= count
        if self.left < 0:
            raise ForbiddenError("the same content again and again, or far more parts than numbers")


class StandIn:
    """Something callable that a pickle cannot change."""

    __slots__ = ("_call",)
    _call: Callable[..., Any]

    def __init__(self, call: Callable[..., Any]) -> None:
        object.__setattr__(self, "_call", call)

    def __setattr__(self, name: str, value: Any) -> None:
        raise ForbiddenError("a state of what it calls")

    def __setstate__(self, state: Any) -> None:
        raise ForbiddenError("a state of what it calls")

    def __call__(self, *arguments: Any) -> Any:
        """What the stand-in makes of its arguments."""
        return self._call(*arguments)


class DataType:
    """Remembers a numpy data type; `numpy.dtype` itself would let a pickle forge one that holds pointers."""

    __slots__ = ("code", "order")

    def __init__(self, code: str, align: Any = False, copy: Any = False) -> None:
        # No length of zero: any number of such texts would take no bytes of the file.
        if not re.fullmatch(r"[biufcSU][1-9]\d{0,5}", code):
            raise ForbiddenError(f"numpy data type {code}")
        self.code = code
        self.order = "="

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _, order, subarray, names, fields, *_ = state
        if order not in ("<", ">", "=", "|") or (subarray, names, fields) != (None, None, None):
            raise ForbiddenError("a numpy data type of several fields")
        self.order = order

    @property
    def real(self) -> np.dtype:
        """The data type."""
        return np.dtype(self.order + self.code)


class Array:
    """Remembers a numpy array until the pickle has ended."""

    __slots__ = ("_budget", "value")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, budget: Budget) -> None:
        self._budget = budget
        self.value = np.empty(0)

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _, shape, dtype, fortran, content = state
        if not isinstance(dtype, DataType) or not isinstance(content, bytes | bytearray | str):
            raise ForbiddenError("a numpy array of objects")
        self._budget.spend(_ARRAY + len(content))
        raw = content.encode("latin1") if isinstance(content, str) else bytes(content)
        self.value = np.ndarray(shape, dtype.real, raw, order="F" if fortran else "C").copy()


def stand_ins(budget: Budget) -> dict[tuple[str, str], StandIn]:
    """Every name that a pickle may use, by module and name."""
    calls = _plain_types(budget)
    array, from_buffer, scalar = _array_calls(budget)
    for core in ("numpy.core", "numpy._core"):
        calls[f"{core}.multiarray", "_reconstruct"] = array
        calls[f"{core}.multiarray", "scalar"] = scalar
        calls[f"{core}.numeric", "_frombuffer"] = from_buffer
    calls["numpy", "ndarray"] = _refused
    calls["numpy", "dtype"] = DataType
    return {name: StandIn(call) for name, call in calls.items()}


def _array_calls(budget: Budget) -> tuple[Callable[..., Any], Callable[..., Any], Callable[..., Any]]:
    """For `_reconstruct(ndarray, (0,), b"b")`, whose state follows, for `_frombuffer(content, dtype, shape, order)`, an
    array in protocol 5, and for `scalar(dtype, content)`, a number.
    """

    def from_buffer(content: Any, dtype: Any, shape: Any, order: str) -> Array:
        array = Array(budget)
        array.__setstate__((1, shape, dtype, order == "F", content))
        return array

    def scalar(dtype: Any, content: Any) -> Any:
        return from_buffer(content, dtype, (), "C").value[()]

    return lambda kind, shape, code: Array(budget), from_buffer, scalar


def _plain_types(budget: Budget) -> dict[tuple[str, str], Callable[..., Any]]:
    """Plain types that pickles import by name, and the codec by which protocols before 3 write bytes."""

    def encode(text: str, encoding: str) -> bytes:
        if encoding != "latin1":
            raise ForbiddenError(f"the codec {encoding}")
        budget.spend(len(text))
        return text.encode("latin1")

    def collected(kind: Callable[..., Any]) -> Callable[..., Any]:
        def collect(items: Any = ()) -> Any:
            budget.spend(_ARRAY + _ITEM * len(items))
            return kind(hashable(items))

        return collect

    def ordered(pairs: Any = ()) -> OrderedDict[Any, Any]:
        budget.spend(_ARRAY + 2 * _ITEM * len(pairs))
        found = [(key, value) for key, value in pairs]
        hashable(key for key, _ in found)
        return OrderedDict(found)

    def complex_number(real: float, imaginary: float) -> complex:
        if not (isinstance(real, float) and isinstance(imaginary, float)):
            raise ForbiddenError("a complex number of anything but two numbers")
        return complex(real, imaginary)

    calls: dict[tuple[str, str], Callable[..., Any]] = {("_codecs", "encode"): encode}
    calls["collections", "OrderedDict"] = ordered
    for module in ("builtins", "__builtin__"):
        calls[module, "set"] = collected(set)
        calls[module, "frozenset"] = collected(frozenset)
        calls[module, "complex"] = complex_number
        # `bytes()`, by which protocols before 3 write empty bytes.
        calls[module, "bytes"] = lambda: b""
    return calls


def _refused(*_: Any) -> Any:
    raise ForbiddenError("numpy.ndarray as a call")


def hashable(keys: Iterable[Any]) -> list[Any]:
    """The same keys.

    Raises:
        ForbiddenError: one is neither of `KEYS` nor a flat tuple of at most `LONGEST_KEY` of them, or a number of more
            than 64 bits.
    """
    found = list(keys)
    for key in found:
        parts = key if isinstance(key, tuple) else (key,)
        if len(parts) > LONGEST_KEY or not all(map(_simple, parts)):
            raise ForbiddenError(f"a key of type {type(key).__name__} that is none of a few short parts")
    return found


def _simple(part: Any) -> bool:
    return isinstance(part, KEYS) and not (isinstance(part, int) and part.bit_length() > 64)
