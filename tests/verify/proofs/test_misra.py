"""The MISRA addon of cppcheck reports nothing for clean C, finds planted violations, and is known to have run."""

from collections.abc import Callable
from pathlib import Path

import pytest

from synth.errors import CompileError
from synth.verify.proofs import prove
from tests import tools

Plant = Callable[[str, str], dict[str, str]]
needs_cppcheck = tools.needs("cppcheck", shows="that the C has no finding, and planted violations are found")


@needs_cppcheck
def test_clean_c_has_no_finding(files: dict[str, str]) -> None:
    report = prove.inspect(files)
    assert (report.files, report.findings) == (("hover.c", "hover.h"), ())
    assert all(check.passed for check in report.checks())
    assert "no claim of compliance" in report.checks()[0].about


@needs_cppcheck
@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("(state->bad_g1 + 1u) : 5u", "(state->bad_g1 + 1u) : 5", "10.4"),
        ("const bool good_r =", "const int good_r =", "10.3"),
        ("(0.9f * state->v) + (260.0f * e)", "0.9f * state->v + (260.0f * e)", "12.1"),
        ("const float i2 = d * a2;", "const float i2 = (float)(uint32_t)(d * a2);", "10.8"),
    ],
)
def test_a_planted_violation_is_found(planted: Plant, old: str, new: str, rule: str) -> None:
    report = prove.inspect(planted(old, new))
    assert {(f.rule, f.file) for f in report.findings} == {(f"misra-c2012-{rule}", "hover.c")}
    assert not all(check.passed for check in report.checks())


@needs_cppcheck
def test_a_violation_in_a_header_is_found(files: dict[str, str]) -> None:
    header = files["hover.h"].replace("#endif", "typedef int hover_unused_t;\n#endif")
    findings = prove.inspect(files | {"hover.h": header}).findings
    assert ("misra-c2012-2.3", "hover.h") in {(f.rule, f.file) for f in findings}


@needs_cppcheck
def test_c_that_cannot_be_read_is_named(planted: Plant) -> None:
    with pytest.raises(CompileError, match=r"cppcheck: reports an error(?s:.*)hover\.c"):
        prove.inspect(planted("if (latched) {", "if (latched) {{"))


def test_an_addon_that_misses_the_known_violation_is_refused(
    files: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blind = tmp_path / "cppcheck"
    blind.write_text("#!/bin/sh\nexit 0\n")
    blind.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(CompileError, match="did not find the known violation"):
        prove.inspect(files)


def test_a_missing_tool_is_named(files: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(CompileError, match=r"cppcheck: not on the PATH.*apt-get install cppcheck"):
        prove.inspect(files)
