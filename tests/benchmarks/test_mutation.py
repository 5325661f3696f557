"""Mutation testing of a planted module: its mutants, who kills them, and the comparison of two runs."""

import ast
import json
from dataclasses import asdict
from pathlib import Path

import pytest

from benchmarks import mutation

pytestmark = pytest.mark.whole

MODULE = Path("gear/ratio.py")
TEXT = """from typing import TYPE_CHECKING

if TYPE_CHECKING:
    LIMIT = 7


def is_low(teeth: int = 5) -> bool:
    count: int | None = teeth
    if teeth < 0:
        raise ValueError("less than " + "0")
    return count < 3


def count(n: int) -> int:
    return n + 1
"""
OWN = "from gear import ratio\n\ndef test_is_low():\n    assert ratio.is_low(2) and not ratio.is_low(4)\n"
NEIGHBOUR = "import pytest\nfrom gear.ratio import count\n\n{}def test_count():\n    assert count(3) == 4\n"
SLOW = "@pytest.mark.slow\n"


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository of one module, with a test of it, one of another that imports it, and one that does not."""
    for name, text in {
        "gear/ratio.py": TEXT,
        "tests/test_ratio.py": OWN,
        "tests/test_train.py": NEIGHBOUR.format(""),
        "tests/test_wheel.py": "def test_nothing():\n    assert True\n",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(mutation, "LIBRARIES", ())  # only to save each mutant their import
    return tmp_path


def changed(text: str) -> list[str]:
    return [mutation.mutate(text, k)[2].split("  ->  ")[1] for k in range(len([*mutation.changes(ast.parse(text))]))]


def test_each_kind_of_operator_changes() -> None:
    assert changed("a < b") == ["a <= b", "a >= b"]
    assert changed("a + b * c") == ["a - b * c", "b / c"]
    assert changed("a and not b") == ["a or not b", "not not b"]
    assert changed("x = True, 2, -y, 's'") == ["False", "3", "+y"]
    assert changed("k += v") == ["k -= v"]
    assert changed("def f() -> bool:\n    return a == b") == ["return not a == b", "a != b"]
    assert changed("def f(x: int | None) -> float:\n    return x") == ["return -x"]
    assert changed("def f(x: 'A') -> str:\n    return x") == []


def test_messages_types_and_what_only_types_need_stay() -> None:
    lines = {mutation.mutate(TEXT, k)[1] for k in range(len([*mutation.changes(ast.parse(TEXT))]))}
    assert lines == {7, 9, 11, 15}


def test_a_kill_is_found_and_a_survivor_is_named(planted: Path) -> None:
    result = mutation.measure(MODULE, 100, 0)
    assert result.tests == ("tests/test_ratio.py", "tests/test_train.py")
    survivors = {(m.line, m.change) for m in result.mutants if not m.killed}
    assert (11, "count < 3  ->  count <= 3") in survivors and (7, "5  ->  6") in survivors
    assert {(m.line, m.change) for m in result.mutants} - survivors >= {
        (11, "count < 3  ->  count >= 3"),
        (11, "return count < 3  ->  return not count < 3"),
        (15, "n + 1  ->  n - 1"),
        (15, "return n + 1  ->  return -(n + 1)"),
    }
    shown = [*mutation.table([result])]
    assert "    survived, line 11: count < 3  ->  count <= 3" in shown
    assert shown[1].split() == ["gear/ratio.py", str(len(result.mutants)), str(result.kills)]


def test_slow_tests_of_neighbours_are_left_out_and_those_of_the_module_are_not(planted: Path) -> None:
    (planted / "tests/test_train.py").write_text(NEIGHBOUR.format(SLOW))
    (planted / "tests/test_ratio.py").write_text(OWN.replace("def test", f"import pytest\n{SLOW}def test"))
    killed = {m.line for m in mutation.measure(MODULE, 100, 0).mutants if m.killed}
    assert 11 in killed and 15 not in killed


def test_an_endless_loop_is_killed(planted: Path) -> None:
    tree = ast.parse(TEXT.replace("return n + 1", "while n: n = 1"))
    status, processor, _ = mutation.run_tests(MODULE, tree, planted / "cache", (2.0, 100.0))
    assert status < 0 and 1.0 < processor < 10.0


def test_seed_and_text_decide_the_mutants(planted: Path) -> None:
    first, again, other = (mutation.measure(MODULE, 3, seed).mutants for seed in (1, 1, 2))
    assert first == again != other and len(first) == 3


def test_fewer_kills_than_before_are_a_loss(planted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    saved = ["gear/ratio.py", "--mutants", "100", "--json", "before.json"]
    again = ["gear/ratio.py", "--mutants", "100", "--compare", "before.json"]
    assert mutation.main(saved) == 0 and mutation.main(again) == 0
    (planted / "tests/test_ratio.py").write_text(OWN.replace("and not ratio.is_low(4)", "or True"))
    assert mutation.main(again) == 1
    assert "killed, before" in capsys.readouterr().out.splitlines()[-1]


def test_a_module_that_is_not_run_again_is_a_loss() -> None:
    before = mutation.Result("a.py", "0", (), (mutation.Mutant(1, "x", True), mutation.Mutant(2, "y", False)))
    document = json.loads(json.dumps([asdict(before)]))
    assert [*mutation.losses([before], document)] == []
    assert [*mutation.losses([], document)] == ["a.py: not run, before 1 of 2 killed"]
    later = mutation.Result("a.py", "1", (), (mutation.Mutant(1, "x", True), *before.mutants[1:] * 2))
    assert [*mutation.losses([later], document)] == [
        "a.py: 1 of 3 killed, before 1 of 2; its text has changed, and so have the mutants"
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [("def test_n():\n    assert 0\n", "fail without a mutant"), ("def test_n():\n    pass\n", "do not import it")],
)
def test_tests_that_judge_nothing_are_refused(planted: Path, text: str, message: str) -> None:
    (planted / "tests/test_ratio.py").write_text(text)
    (planted / "tests/test_train.py").unlink()
    with pytest.raises(SystemExit, match=message):
        mutation.measure(MODULE, 1, 0)
    (planted / "tests/test_ratio.py").unlink()
    with pytest.raises(SystemExit, match=r"gear/ratio.py: no test file of its name"):
        mutation.measure(MODULE, 1, 0)


def test_the_default_modules_have_tests_and_lie_in_ten_folders_or_are_ten() -> None:
    assert len({*mutation.MODULES}) > 10 and len({Path(name).parent for name in mutation.MODULES}) >= 9
    assert all(mutation.tests_of(Path(name)) for name in mutation.MODULES)
