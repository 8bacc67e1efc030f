import sys
from pathlib import Path

import pytest

from sag.errors import SagError
from sag.letters import LETTERS, components_of, row_name
from sag.sweep.command import Additions, command_hash, row_command, written
from sag.sweep.definition import read_sweep
from sag.sweep.rows import name_of, plan


def planned(workplace, additions=Additions(), seeds=None):  # noqa: B008
    return plan(read_sweep(workplace.folder / "sweep.yaml"), additions, seeds)


def test_names_are_letters_in_the_papers_order():
    point = {"components.context": True, "components.separate": True, "components.projection": False}
    assert name_of(point, list(point)) == "mc"
    assert name_of(dict.fromkeys(point, False), list(point)) == "none"
    assert name_of({f"components.{name}": True for name in reversed(LETTERS)}, []) == "mdpc"


@pytest.mark.parametrize("bits", range(16))
def test_a_row_name_and_its_components_are_the_same_thing(bits):
    components = {name: bool(bits >> place & 1) for place, name in enumerate(LETTERS)}
    assert components_of(row_name(components)) == components


@pytest.mark.parametrize("name", ["random", "dm", "hp_gan", ""])
def test_other_names_have_no_components(name):
    assert components_of(name) is None


@pytest.mark.parametrize(
    ("point", "varied", "name"),
    [
        ({"config": "configs/ablations/mdp.yaml"}, ["config"], "mdp"),
        ({"config": "configs/ablations/mdp.yaml", "seed_everything": 1}, ["config"], "mdp-s1"),
        ({"model.init_args.critic_steps": 3, "b": "x"}, ["model.init_args.critic_steps"], "critic_steps=3"),
        ({"a.rate": 1, "b.rate": 2}, ["a.rate", "b.rate"], "a.rate=1-b.rate=2"),
        ({"path": "../no where/x"}, ["path"], "path=.._no_where_x"),
        ({"a": [1, 2]}, ["a"], "a=_1_2_"),
        ({"a": 1}, [], "row"),
    ],
)
def test_other_parameters_name_a_row_by_what_varies(point, varied, name):
    assert name_of(point, varied) == name


def test_values_are_written_as_yaml_reads_them():
    assert [written(v) for v in (True, False, None, 3, 0.5, "x", [1, 2])] == [
        "true", "false", "null", "3", "0.5", "x", "[1, 2]"
    ]  # fmt: skip


def test_a_row_is_the_file_then_the_additions_then_the_rows_own_arguments(workplace):
    workplace.write("extra.yaml", "b: 2")
    rows = planned(workplace, Additions(("extra.yaml",), ("data.root=here", "model.x=1")), seeds=2)
    assert [row.name for row in rows[2:5]] == ["none-s0", "none-s1", "c-s0"]
    start = ("/usr/bin/env", sys.executable, "program.py")
    assert rows[4].command == (
        *start, "run", "--config", "base.yaml", "--config=extra.yaml", "--data.root=here", "--model.x=1",
        "--components.separate=false", "--components.context=true", "--seed_everything=0",
    )  # fmt: skip


def test_preparations_are_the_same_command_with_an_overlay_before_the_settings(workplace):
    workplace.write("extra.yaml", "b: 2")
    encoders, truth = planned(workplace, Additions(("extra.yaml",), ("data.root=here", "model.x=1")))[:2]
    start = ("/usr/bin/env", sys.executable, "program.py")
    own = ("--config", "base.yaml", "--config=extra.yaml")
    overlay = ("--config=configs/methods/erd.yaml", "--model.init_args.retrain=false")
    assert encoders.command == (*start, "fit", *own, *overlay, "--data.root=here")
    assert truth.command == (*start, "test", *own, "--config=configs/methods/ground_truth.yaml", "--data.root=here")


def test_the_blind_row_comes_last_and_is_a_row_like_any_other(workplace):
    workplace.write("extra.yaml", "b: 2")
    rows = planned(workplace, Additions(("extra.yaml",), ("components.context=true", "model.x=1")), seeds=2)
    assert [row.name for row in rows[-3:]] == ["mc-s1", "blind-s0", "blind-s1"]
    assert rows[-1].command == (
        "/usr/bin/env", sys.executable, "program.py", "run", "--config", "base.yaml", "--config=extra.yaml",
        "--config=configs/methods/blind.yaml", "--model.x=1", "--seed_everything=1",
    )  # fmt: skip
    assert rows[-1].measured and rows[-1].typical and not rows[-1].alone


def test_a_changed_blind_config_changes_the_blind_row_alone(workplace):
    before = planned(workplace)
    workplace.write("configs/methods/blind.yaml", "changed: true")
    changed = [row.name for row, old in zip(planned(workplace), before) if row.fingerprint != old.fingerprint]
    assert changed == ["blind"]


RATES = "b.rate: {values: [1, 2]}, c: {value: 3}"
BOTH = {"blind-rate=1": (1, 3), "blind-rate=2": (2, 3)}


@pytest.mark.parametrize(
    ("parameters", "blind"),
    [
        (f"components.depth: {{values: [true, false]}}, {RATES}", BOTH),
        (f"config: {{values: [r/m.yaml, r/md.yaml, r/hp_gan.yaml]}}, {RATES}", BOTH),
        (f"components.depth: {{value: true}}, {RATES}", {}),
        (f"config: {{values: [r/hp_gan.yaml, r/cao.yaml]}}, {RATES}", {}),
        (f"config: {{values: [r/hp_gan.yaml, r/md.yaml]}}, {RATES}", {}),
    ],
    ids=("components", "configs", "no components vary", "other methods", "one row"),
)  # fmt: skip
def test_blind_rows_follow_what_varies_besides_components(workplace, parameters, blind):
    for name in ("m", "md", "hp_gan", "cao"):
        workplace.write(f"r/{name}.yaml", name)
    workplace.write("sweep.yaml", f"{{program: p, command: [sag, run, '${{args}}'], parameters: {{{parameters}}}}}")
    rows = [row for row in planned(workplace) if row.name.startswith("blind")]
    overlay = "--config=configs/methods/blind.yaml"
    wanted = {name: ("sag", "run", overlay, f"--b.rate={rate}", f"--c={c}") for name, (rate, c) in blind.items()}
    assert {row.name: row.command for row in rows} == wanted


def test_rows_start_in_the_checkpoints_of_their_namesakes(workplace):
    folder = workplace.folder / "before"
    with pytest.raises(SagError, match=r"--pretrained .*before: .*none/checkpoints/last\.ckpt is missing; run"):
        planned(workplace, Additions(pretrained=folder))
    names = [row.name for row in planned(workplace) if row.typical]
    for name in names:
        workplace.write(f"before/{name}/checkpoints/last.ckpt", name)
    rows = planned(workplace, Additions(pretrained=folder))
    starts = {row.name: f"--pretrained={folder}/{row.name}/checkpoints/last.ckpt" for row in rows}
    assert [row.name for row in rows if starts[row.name] in row.command] == names
    workplace.write(f"before/{names[0]}/checkpoints/last.ckpt", "trained again")
    again = planned(workplace, Additions(pretrained=folder))
    assert [new.name for new, old in zip(again, rows) if new.fingerprint != old.fingerprint] == names[:1]


def test_other_programs_have_no_blind_row(workplace):
    workplace.write("sweep.yaml", "{program: p, parameters: {components.depth: {values: [true, false]}}}")
    assert [row.name for row in planned(workplace)] == ["d", "none"]


def test_macros_without_hyphens_and_of_the_environment(workplace, monkeypatch):
    monkeypatch.setenv("PLACE", "here")
    workplace.write("s.yaml", """
        {program: p.py, command: ["${interpreter}", "at=${envvar:PLACE}", "${args_no_hyphens}", end],
         parameters: {a: {value: true}, b: {value: 2}}}""")  # fmt: skip
    sweep = read_sweep(workplace.folder / "s.yaml")
    command = row_command(sweep, sweep.points()[0], Additions((), ("c=3",)))
    assert command == [sys.executable, "at=here", "--c=3", "a=true", "b=2", "end"]
    assert [row.name for row in plan(sweep, Additions())] == ["row"]


def test_an_unknown_macro_is_refused(workplace):
    workplace.write("s.yaml", '{program: p, command: ["${args_jason}"], parameters: {a: {value: 1}}}')
    with pytest.raises(SagError, match="args_jason"):
        plan(read_sweep(workplace.folder / "s.yaml"), Additions())


def test_an_unknown_component_is_refused_before_anything_runs(workplace):
    workplace.write("sweep.yaml", "{program: p, parameters: {components.projeciton: {values: [true, false]}}}")
    with pytest.raises(SagError, match="projeciton"):
        planned(workplace)


def test_two_rows_in_one_folder_are_refused(workplace):
    workplace.write("sweep.yaml", "{program: p, parameters: {config: {values: [a/base.yaml, b/base.yaml]}}}")
    workplace.write("a/base.yaml", "")
    workplace.write("b/base.yaml", "")
    with pytest.raises(SagError, match="'base'"):
        planned(workplace)


def test_the_fingerprint_covers_the_bytes_of_every_config_and_what_came_before(workplace):
    command = ["program.py", "--config", "base.yaml", "--config=configs/methods/erd.yaml"]
    before = command_hash(command)
    assert command_hash([sys.executable, *command]) == before, "a moved interpreter changes nothing"
    assert command_hash([*command, "--a=1"]) != before
    assert command_hash(command, after="x") != before
    for name in ("base.yaml", "configs/methods/erd.yaml"):
        workplace.write(name, f"other: {name}")
        assert command_hash(command) != before
        before = command_hash(command)


def test_a_config_of_components_alone_is_its_flags(workplace):
    workplace.write("md.yaml", "# a row\ncomponents:\n  separate: true\n  depth: true\n")
    flags = ["--components.separate=true", "--components.depth=true"]
    before = command_hash(["a", "--config=md.yaml", "--b=1"])
    assert before == command_hash(["a", *flags, "--b=1"])
    assert before != command_hash(["a", flags[0], "--components.depth=false", "--b=1"])
    assert before != command_hash(["a", "--config", "md.yaml", "--b=1"]), "the sweep file's own configs are as they are"
    for more in (
        "components: {separate: true, depth: true}\nc: 1",
        "components: [separate, depth]",
        "components: {",
        "",
    ):
        workplace.write("other.yaml", more)
        assert command_hash(["a", "--config=other.yaml", "--b=1"]) != before


def test_rows_of_the_ablation_and_of_table_1_are_the_same(monkeypatch):
    root = Path(__file__).parents[2]
    monkeypatch.chdir(root)
    ablation, table1 = (
        {row.name: row.fingerprint for row in plan(read_sweep(root / f"sweeps/{name}.yaml"), Additions(), seeds=2)}
        for name in ("ablation", "table1")
    )
    assert len(table1) == 2 + 2 * 7 and table1.items() <= ablation.items()


def test_a_missing_config_is_named(workplace):
    with pytest.raises(SagError, match=r"configs/none\.yaml does not exist"):
        command_hash(["--config=configs/none.yaml"])
