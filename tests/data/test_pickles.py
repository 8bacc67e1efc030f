import builtins
import os
import pickle
import subprocess
import time
from collections import OrderedDict
from pathlib import Path

import numpy as np
import pytest
from hostile_memory import little_memory
from hostile_traps import swellings
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sag.data.pickles import _PlainUnpickler, _resolved, load_pickle
from sag.data.stand_ins import Budget, ForbiddenError, StandIn
from sag.errors import SagError

PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)


def written(folder: Path, content: object, protocol: int = pickle.DEFAULT_PROTOCOL) -> Path:
    path = folder / "content.pkl"
    path.write_bytes(content if isinstance(content, bytes) else pickle.dumps(content, protocol))
    return path


class Calls:
    """Pickles as a call of something."""

    def __init__(self, function, *arguments):
        self.call = (function, arguments)

    def __reduce__(self):
        return self.call


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_arrays_and_plain_types_come_back_in_every_protocol(tmp_path, protocol):
    shared = np.arange(6.0).reshape(2, 3)
    content = {
        "c": shared,
        "again": [shared, (shared, 1)],
        "fortran": np.asfortranarray(np.arange(6, dtype=">i2").reshape(3, 2)),
        "text": np.array(["left", "right"]),
        "empty": np.zeros((0, 3), np.float32),
        "mask": np.array([True, False]),
        "number": np.float64(0.1),
        "plain": [1, 2.5, None, "a", b"\x00\xff", b"", {"k": (True,)}, {1, 2}, frozenset({3}), 1j],
        "ordered": OrderedDict(near=0.1, bones=shared),
    }
    found = load_pickle(written(tmp_path, content, protocol))
    assert found["plain"] == content["plain"]
    assert list(found["ordered"]) == ["near", "bones"] and isinstance(found["ordered"], OrderedDict)
    assert found["number"] == content["number"] and isinstance(found["number"], np.float64)
    for name in ("c", "fortran", "text", "empty", "mask"):
        np.testing.assert_array_equal(found[name], content[name], strict=True)
    assert found["again"][0] is found["c"] and found["again"][1][0] is found["ordered"]["bones"] is found["c"]


@settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text() | st.binary(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner, inner),
    )
)
def test_plain_content_is_unchanged(tmp_path, content):
    assert load_pickle(written(tmp_path, [content])) == [content]


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_honest_pickles_are_never_called_copies(tmp_path, protocol):
    shared = np.arange(250_000.0)
    content = {
        "small": [np.array([n % 2 == 0]) for n in range(500)],
        "numbers": [np.float32(n) for n in range(500)],
        "high": np.full(9999, 255, np.uint8),
        "shared": [shared] * 500,
        "sets": [frozenset({n}) for n in range(500)],
        ("keys", 1): {(n, "x"): None for n in range(500)},
    }
    found = load_pickle(written(tmp_path, content, protocol))
    assert [bool(x[0]) for x in found["small"]] == [n % 2 == 0 for n in range(500)]
    assert found["numbers"] == content["numbers"] and found["sets"] == content["sets"]
    assert (found["high"] == 255).all() and found["shared"][0] is found["shared"][499]
    assert found["keys", 1] == content["keys", 1]


def test_arrays_can_be_written_to(tmp_path):
    found = load_pickle(written(tmp_path, {"a": np.zeros(3)}))
    found["a"][0] = 1
    assert found["a"].sum() == 1


def test_python_2_arrays_are_read_as_latin1(tmp_path):
    # Protocol 2 of Python 2 holds an array's bytes as a string, opcode U.
    raw = np.array([1.5, -2.0]).tobytes()
    state = (
        b"cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\nK\x00\x85U\x01btR"
        b"(K\x01K\x02\x85cnumpy\ndtype\n(U\x02f8K\x00K\x01tR(K\x03U\x01<NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tb"
        b"\x89U" + bytes([len(raw)]) + raw + b"tb."
    )
    np.testing.assert_array_equal(load_pickle(written(tmp_path, b"\x80\x02" + state)), [1.5, -2.0])


def gadgets(canary: Path) -> dict[str, object]:
    touch = f"touch {canary}"
    python = f"open({str(canary)!r}, 'w')"
    return {
        "system": Calls(os.system, touch),
        "popen": Calls(subprocess.Popen, ["touch", str(canary)]),
        "eval": Calls(builtins.eval, python),
        "exec": Calls(builtins.exec, python),
        "open": Calls(builtins.open, str(canary), "w"),
        "getattr": Calls(builtins.getattr, "a", "upper"),
        "numpy_load": Calls(np.load, str(canary)),
        "numpy_inside": {"a": [np.zeros(2), Calls(os.mkdir, str(canary))]},
        "by_line": b"cposix\nsystem\n(S'" + touch.encode() + b"'\ntR.",
        "by_instance": b"(S'" + touch.encode() + b"'\niposix\nsystem\n.",
        "codec": b"\x80\x02c_codecs\nencode\nX\x01\x00\x00\x00aX\x05\x00\x00\x00rot13\x86R.",
        "dotted_name": b"\x80\x04\x8c\x05numpy\x8c\x0c__loader__.x\x93.",
        "builtins_by_numpy": b"\x80\x04\x8c\x05numpy\x8c\x0ef2py.os.system\x93\x8c\x01a\x85R.",
    }


@pytest.mark.parametrize("name", sorted(gadgets(Path("canary"))))
@pytest.mark.parametrize("protocol", [0, 2, 5])
def test_what_calls_anything_is_refused_and_not_run(tmp_path, name, protocol):
    canary = tmp_path / "canary"
    path = written(tmp_path, gadgets(canary)[name], protocol)
    with pytest.raises(SagError, match=r"content\.pkl is refused because it names \w+"):
        load_pickle(path)
    assert not canary.exists()


def test_the_refusal_holds_the_forbidden_name(tmp_path):
    with pytest.raises(SagError, match=r"names (posix|nt)\.system"):
        load_pickle(written(tmp_path, Calls(os.system, "true")))


def test_the_refusal_is_short_whatever_the_name(tmp_path):
    with pytest.raises(SagError) as error:
        load_pickle(
            written(
                tmp_path, b"\x80\x04\x8c\x02os" + b"X" + (50_000).to_bytes(4, "little") + 25_000 * b"x\n" + b"\x93."
            )
        )
    assert len(str(error.value)) < 600 and "\n" not in str(error.value)


@pytest.mark.parametrize("name", sorted(swellings()))
def test_what_would_swell_is_refused_with_little_memory_and_soon(tmp_path, name):
    path = written(tmp_path, swellings()[name])
    start = time.process_time()
    with little_memory(), pytest.raises(SagError, match=r"content\.pkl"):
        load_pickle(path)
    assert time.process_time() - start < 20


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_frames_such_as_gta_ims_never_take_too_much(tmp_path, protocol):
    names, random = [f"SKEL_{number}" for number in range(98)], np.random.default_rng(0)
    frame = [{"kpname": names[::-1], "kpvalue": random.random(294).tolist(), "cam": list(random.random((21, 3)))}]
    content = pickle.dumps([pickle.loads(pickle.dumps(frame)) for _ in range(100)], protocol)
    reader = _PlainUnpickler(content)
    before = reader.budget.left
    _resolved(reader.load(), {}, reader.budget)
    # The base is left to small files: the frames of any length stay within their share.
    assert before - reader.budget.left < before - Budget(0).left


def test_files_above_the_limit_are_refused(tmp_path):
    path = written(tmp_path, [bytes(1000)])
    assert load_pickle(path, 1100) == [bytes(1000)]
    with pytest.raises(SagError, match=r"content\.pkl is larger than the 1,000 bytes"):
        load_pickle(path, 1000)


def test_stand_ins_cannot_be_changed():
    call = StandIn(len)
    for change in (lambda: setattr(call, "_call", print), lambda: call.__setstate__(({}, {"_call": print}))):
        with pytest.raises(ForbiddenError):
            change()
    assert call("abc") == 3


def test_arrays_of_objects_are_refused(tmp_path):
    with pytest.raises(SagError, match="numpy data type O8"):
        load_pickle(written(tmp_path, np.array([None, {}], object)))


@pytest.mark.parametrize(
    "state",
    [
        b"(K\x03X\x02\x00\x00\x00O,NNNK\x08K\x01K\x00tb",  # a byte order that smuggles objects in
        b"(K\x03X\x01\x00\x00\x00|NX\x01\x00\x00\x00a\x85}K\x08K\x01K\x00tb",  # fields
    ],
)
def test_forged_data_types_are_refused(tmp_path, state):
    forged = b"\x80\x02cnumpy\ndtype\n(X\x02\x00\x00\x00f8K\x00K\x01tR" + state + b"."
    with pytest.raises(SagError, match="several fields"):
        load_pickle(written(tmp_path, forged))


def test_an_array_larger_than_its_bytes_is_refused(tmp_path):
    honest = pickle.dumps(np.zeros(2), 2)
    with pytest.raises(SagError, match="cannot be read"):
        load_pickle(written(tmp_path, honest.replace(b"K\x02\x85", b"K\x7f\x85")))


def test_what_the_reader_stands_on_cannot_be_changed(tmp_path):
    changing = b"\x80\x02c_codecs\nencode\n}X\x01\x00\x00\x00aK\x01sb."
    with pytest.raises(SagError):
        load_pickle(written(tmp_path, changing))


def test_a_nest_of_shared_lists_is_read_in_linear_time(tmp_path):
    nest: list = []
    for _ in range(200):
        nest = [nest, nest]
    found = load_pickle(written(tmp_path, nest))
    assert found[0] is found[1]


@pytest.mark.parametrize("content", [b"", b"\x80\x05", b"not a pickle", pickle.dumps([1.0] * 50)[:-9]])
def test_damaged_files_are_refused_by_name(tmp_path, content):
    with pytest.raises(SagError, match=r"content\.pkl cannot be read"):
        load_pickle(written(tmp_path, content))


def test_a_missing_file_is_refused_by_name(tmp_path):
    with pytest.raises(SagError, match=r"absent\.pkl"):
        load_pickle(tmp_path / "absent.pkl")
