"""Dense laws emit as tables and loops: lines, what the C computes, and defects of a table that the comparison finds."""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from benchmarks import chain
from synth.blocks.laws import linear_block
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.verify import meter, steps
from tests import tolerances, tools

MOST_LINES = 250  # beside the tables
DOUBLE = tolerances.of("double")

_ROW = re.compile(r" {8}/\* \w+ \*/\n(?: {8}-?\d[^\n]*\n)+")


def test_eight_masses_are_short_and_compute_what_casadi_does() -> None:
    growth = chain.measure_growth(8)
    assert growth.lines <= MOST_LINES and growth.worst <= DOUBLE


@pytest.mark.whole
def test_twenty_four_masses_are_short_and_compute_what_casadi_does() -> None:
    growth = chain.measure_growth(24)
    assert growth.lines <= MOST_LINES and growth.worst <= DOUBLE


def test_four_masses_have_a_name_for_each_coefficient(monkeypatch: pytest.MonkeyPatch) -> None:
    text = chain.emit(4, np.float32).files["chain_4.c"]
    assert "_matrix" not in text and "static const float next_q1_predicted_from_y1 = " in text
    monkeypatch.setattr(linear_block, "FEWEST", 100)
    assert "static const float matrix[128] = {" in chain.emit(4, np.float32).files["chain_4.c"]


@pytest.mark.parametrize("defect", ["entry", "rows", "column"])
def test_a_defect_of_a_table_is_found(defect: str) -> None:
    made, double = chain.block(8), chain.emit(8, np.float64)
    text = double.files["chain_8.c"]
    first, second = _ROW.findall(text[text.index("state_matrix_times(") :])[:2]
    number = re.findall(r"-?\d\.\d+(?:e-\d+)?", first)[0]
    wrong = {
        "entry": text.replace(number, repr(float(number) * (1 + 1e-7)), 1),
        "rows": text.replace(first + second, second + first),
        "column": text.replace("second_sum += second[j] * x[j]", "second_sum += second[j] * x[j - 1u]"),
    }[defect]
    assert wrong != text
    planted = EmittedCode(double.files | {"chain_8.c": wrong}, double.manifest)
    assert chain.disagreement(made, double) <= DOUBLE < 10 * DOUBLE < chain.disagreement(made, planted)


@tools.needs("arm-none-eabi-gcc", shows="that its analysis of the loops has nothing to warn about")
def test_gcc_for_arm_warns_about_no_loop(tmp_path: Path) -> None:
    files = chain.emit(8, np.float32).files
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    target = ("-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-std=c99")
    warnings = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
    for level in ("-O2", "-Os"):
        command = ["arm-none-eabi-gcc", *target, *warnings, level, "-c", "chain_8.c", "-o", "chain_8.o"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def test_the_table_has_a_line_for_each_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chain, "COUNTS", (4, 8))
    title, *lines = chain.table()
    assert [line.split()[0] for line in lines] == ["4", "8"] and title.startswith("masses")


@pytest.fixture(scope="module")
def costs() -> dict[tuple[int, bool, str], tuple[float, int]]:
    """Return by masses, whether the law has tables, and build: the most instructions of a step, and bytes of flash."""
    measured = {}
    for n in (8, 24):
        for has_tables in (True, False):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(linear_block, "FEWEST", linear_block.FEWEST if has_tables else 10**9)
                single = chain.emit(n, np.float32)
            sequence = steps.in_range(host.load(single.files, single.manifest), 20)
            for build in meter.builds():
                run = meter.run(meter.emitted_source(single), sequence, build)
                flash = run.size.code + run.size.literals + run.size.constants
                measured[n, has_tables, build.name] = (float(run.cost.instructions.max()), flash)
    return measured


@pytest.mark.whole
@pytest.mark.parametrize("build", tools.BUILDS[:2] + tools.BUILDS[3:])
@pytest.mark.parametrize(("n", "most_flash"), [(8, 0.45), (24, 1 / 3)])
def test_loops_cost_few_instructions_and_save_flash(
    costs: dict[tuple[int, bool, str], tuple[float, int]], build: meter.Build, n: int, most_flash: float
) -> None:
    """Beside sums 24 masses need less than a third of the flash; of 8 masses the limits of the states need more."""
    (instructions, flash), (before, flash_before) = costs[n, True, build.name], costs[n, False, build.name]
    assert instructions <= 1.3 * before and flash <= most_flash * flash_before
