"""Bytes are known by hand: instructions, literals and tables of given sizes."""

from pathlib import Path

import pytest

from synth.errors import CompileError
from synth.execute import cross, elf
from tests import tools
from tests.execute import planted
from tests.execute.planted import assembly

TABLE = """static const float table[100] = {1.5f, [99] = 2.5f};
static const float other[7] = {3.5f, [6] = 4.5f};
static unsigned counter, zeroed[8];
static unsigned started = 3u;
float look(unsigned i); float look_elsewhere(unsigned i); unsigned tick(unsigned i);
float look(unsigned i) { return table[i % 100u]; }
float look_elsewhere(unsigned i) { return other[i % 7u]; }
unsigned tick(unsigned i) { zeroed[i & 7u] += ++counter; return started += zeroed[3]; }
"""


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_instructions_and_literals_are_distinguished(compiler: str) -> None:
    sources = assembly("f", "ldr r0, 1f; bx lr; .align 2; 1: .word 12345678; .word 2; .word 3")
    size = planted.size(sources, "f", compiler=compiler)
    assert (size.code, size.literals, size.constants, size.data) == (4, 12, 0, 0)
    assert size.functions == {"f": 16}


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_tables_and_variables_count_where_they_are_reached(compiler: str) -> None:
    look, elsewhere, tick = (
        planted.size({"f.c": TABLE}, f, compiler=compiler) for f in ("look", "look_elsewhere", "tick")
    )
    assert (look.constants, elsewhere.constants, tick.constants) == (400, 28, 0)
    assert (look.data, elsewhere.data) == (0, 0)
    assert tick.data == 4 + 4 + 32  # started, counter, zeroed: no byte of it is hidden
    assert set(look.functions) == {"look"} and set(tick.functions) == {"tick"}


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_libm_and_run_time_functions_count(compiler: str) -> None:
    plain = "float f(float x);\nfloat f(float x) { return x; }\n"
    single = "#include <math.h>\nfloat f(float x);\nfloat f(float x) { return tanhf(x); }\n"
    double = "float f(float x);\nfloat f(float x) { return (float)(x * 0.1); }\n"
    sizes = [planted.size({"f.c": text}, "f", compiler=compiler) for text in (plain, single, double)]
    assert not sizes[0].literals + sizes[0].constants and sizes[0].code in (2, 4)  # bx lr, and perhaps padding
    assert "tanhf" in sizes[1].functions and sizes[1].code > 300
    assert {"__aeabi_dmul", "__muldf3"} & set(sizes[2].functions) and sizes[2].code > 500  # two names of one function
    for size in sizes:
        assert 0 <= size.code + size.literals - sum(size.functions.values()) < 4 * len(size.functions)  # padding


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS[1:])  # zig would build a musl of its own for -s
def test_an_image_without_symbols_is_refused(compiler: str) -> None:
    path = cross.link(assembly("f", "bx lr"), ["f"], "cortex-m4f", compiler, ["-s"])
    with pytest.raises(CompileError, match="no symbol table"):
        elf.read(path)


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_segments_hold_the_instructions(compiler: str) -> None:
    program = elf.read(cross.link(assembly("f", "movs r0, #7; bx lr"), ["f"], "cortex-m4f", compiler))
    at = program.address("f")
    inside = [s.content[at - s.address :][:4] for s in program.segments if 0 <= at - s.address < len(s.content)]
    assert inside == [bytes.fromhex("0720 7047")] and at % 2 == 0


def test_objects_name_what_they_define_and_need(tmp_path: Path) -> None:
    text = "int g(int); int f(int); static int __attribute__((noinline)) h(int x) { return g(x) + 1; }\n"
    (path,) = cross.objects({"f.c": text + "int f(int x) { return h(x) * 2; }\n"}, "cortex-m4f")
    assert (
        elf.defined_functions(path) == {"f", "h"}
        and "g" in elf.undefined_symbols(path)
        and "f" not in elf.undefined_symbols(path)
    )
