"""Commands: `synth build | verify | simulate | faults | study | compare | tune | audit | cost | prove | emit | export |
new`.

It runs in the root of a workspace.

With --json stdout is one document and progress goes to stderr. Exit status: 0 passed, 1 a check failed, 2 wrong usage,
130 interrupted by Ctrl-C, 143 terminated. A command imports its modules when it runs: the help and the completion of
the shell answer at once. `synth --install-completion` makes the shell complete commands and names of designs.
"""

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from synth.base import threads

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Physics to verified C for precision stages. Run it in the root of a workspace.",
    epilog="Example: synth new my_stage && cd my_stage && synth build",
)


AFTER_INTERRUPTION = "finished results are kept and no file is half-written; run the same command again to continue"


class Core(StrEnum):
    """A processor that the emulator runs."""

    M4F = "cortex-m4f"
    M7 = "cortex-m7"


class Scalar(StrEnum):
    """A scalar type of the emitted C."""

    FLOAT32 = "float32"
    FLOAT64 = "float64"


class Sampling(StrEnum):
    """How the machines of a study are drawn."""

    UNIFORM = "uniform"
    NORMAL = "normal"
    CORNERS = "corners"
    LATIN = "latin"


def _complete(incomplete: str) -> list[str]:
    """Return the designs of the workspace whose names begin with `incomplete`."""
    return sorted(path.parent.name for path in Path().glob(f"designs/{incomplete}*/design.py"))


Name = Annotated[str, typer.Argument(help="the design", autocompletion=_complete)]
Names = Annotated[
    list[str] | None,
    typer.Argument(metavar="NAME", help="designs; all when left out", autocompletion=_complete),
]
AsJson = Annotated[bool, typer.Option("--json", help="print one JSON document, progress on stderr")]
Fresh = Annotated[bool, typer.Option("--fresh", help="ignore the cache of earlier runs")]


@app.callback()
def _commands() -> None:
    """Physics to verified C for precision stages."""


def main() -> None:
    """Run the command line; print an error of this package or of a file in one line and exit with 2."""
    threads.use_one()
    try:
        with _interruptible():
            app()
    except Interrupted as interrupt:
        sys.stderr.write(f"interrupted: {AFTER_INTERRUPTION}\n")
        raise SystemExit(interrupt.code) from None
    except Exception as error:
        from synth.errors import SynthError

        if not isinstance(error, SynthError | OSError):
            raise
        from rich.console import Console
        from rich.markup import escape

        Console(stderr=True).print(f"[bold red]error:[/] {escape(str(error))}", highlight=False, soft_wrap=True)
        raise SystemExit(2) from error


class Interrupted(SystemExit):
    """The end by a signal, which neither typer nor a job handles."""


@contextmanager
def _interruptible() -> Iterator[None]:
    """Raise Interrupted inside, with the exit status of a shell, on Ctrl-C and on a request to terminate."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, _interrupt) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, _: object) -> NoReturn:
    raise Interrupted(128 + number)


@app.command(epilog="Example: synth build my_stage")
def build(names: Names = None, as_json: AsJson = False, fresh: Fresh = False) -> None:
    """Regenerate gains and C, verify, simulate, audit, and write the report of each design."""
    from synth.app import commands

    raise typer.Exit(commands.build(names or (), as_json, fresh))


@app.command(epilog="Example: synth verify my_stage --target cortex-m4f")
def verify(
    names: Names = None,
    as_json: AsJson = False,
    core: Annotated[
        Core | None, typer.Option("--target", help="replay on cortex-m4f (float32) or cortex-m7 (float64) instead")
    ] = None,
    serial: Annotated[
        str | None, typer.Option(help="replay one design's vectors on a board on this line instead: /dev/ttyACM0")
    ] = None,
    baud: Annotated[int, typer.Option(help="rate of --serial, bits per second")] = 115200,
    fresh: Fresh = False,
) -> None:
    """Compare the emitted C with the reference, CasADi and CasADi's own C, with longer replays than `build`.

    With --target, compare the machine code of a Cortex-M core, in an emulator, with this machine's, bit by bit. With
    --serial, a board that runs serial.c of `synth export --target mcu` computes the test vectors, bit by bit.
    """
    from synth.app import commands

    if serial:
        if len(names or ()) != 1 or core:
            raise typer.BadParameter("one design, and no --target, is needed with --serial: give its name")
        raise typer.Exit(commands.verify_board((names or [""])[0], serial, baud, as_json))
    raise typer.Exit(commands.verify(names or (), as_json, fresh, core))


@app.command(epilog="Example: synth cost my_stage --json")
def cost(names: Names = None, as_json: AsJson = False, fresh: Fresh = False) -> None:
    """Measure the cost of a step on a Cortex-M4F, beside CasADi's C: instructions, bytes, decisions. No verdicts."""
    from synth.app import commands

    raise typer.Exit(commands.cost(names or (), as_json, fresh))


@app.command(epilog="Example: synth prove my_stage --whole")
def prove(
    names: Names = None,
    as_json: AsJson = False,
    whole: Annotated[bool, typer.Option("--whole", help="prove at full depth instead of a subset")] = False,
    fresh: Fresh = False,
) -> None:
    """Prove the emitted C: Eva, inputs that are not finite, fuzzing under sanitizers, cppcheck's misra addon."""
    from synth.app import commands

    raise typer.Exit(commands.prove(names or (), as_json, fresh, whole))


@app.command(epilog="Example: synth margins my_stage")
def margins(names: Names = None, as_json: AsJson = False, fresh: Fresh = False) -> None:
    """Tell whether the loops are stable, then their poles and margins, before there is a reference or any C.

    At the operating points and the corners of the tolerances; the least margins are held against what is required.
    """
    from synth.app import commands

    raise typer.Exit(commands.margins(names or (), as_json, fresh))


@app.command(epilog="Example: synth simulate my_stage")
def simulate(names: Names = None, as_json: AsJson = False, fresh: Fresh = False) -> None:
    """Run each design's experiments on the full plant with the compiled C in the loop."""
    from synth.app import commands

    raise typer.Exit(commands.simulate(names or (), as_json, fresh))


@app.command(epilog="Example: synth faults my_stage --plants 17")
def faults(
    names: Names = None,
    as_json: AsJson = False,
    plants: Annotated[int, typer.Option(min=1, help="nominal and perturbed plants; 17 for a full campaign")] = 4,
    every: Annotated[bool, typer.Option("--every", help="a row for each sensor and actuator")] = False,
    sweep: Annotated[
        bool, typer.Option("--sweep", help="also smallest noticed magnitudes and tolerated times")
    ] = False,
    write: Annotated[
        bool, typer.Option("--write", help="lose each sensor and write safe_output.json, for the datasheet")
    ] = False,
    fresh: Fresh = False,
) -> None:
    """Inject faults of sensors, actuators and calls into the closed loop and measure what they do to the machine."""
    from synth.app import commands

    if write and (every or sweep):
        raise typer.BadParameter("with --write, leave out --every and --sweep: it only loses sensors")
    if write:
        raise typer.Exit(commands.measure_safe_output(names or (), as_json, fresh, plants))
    raise typer.Exit(commands.faults(names or (), as_json, fresh, plants, every, sweep))


@app.command(epilog="Example: synth study my_stage --plants 1000 --experiments 'step_*'")
def study(
    name: Name,
    as_json: AsJson = False,
    plants: Annotated[int, typer.Option(min=1, help="machines to draw; the first is the nominal one")] = 200,
    experiments: Annotated[
        list[str] | None, typer.Option(help="pattern of experiments' names; may be repeated")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="seed of the machines")] = 0,
    sampling: Annotated[
        Sampling, typer.Option(help="how machines are drawn within their tolerances")
    ] = Sampling.UNIFORM,
    row: Annotated[int | None, typer.Option(min=0, help="run this row of the table alone, and show all of it")] = None,
    csv: Annotated[Path | None, typer.Option(help="file for the whole table, a row a machine")] = None,
    parquet: Annotated[Path | None, typer.Option(help="the same as Parquet; needs pyarrow")] = None,
    report: Annotated[Path | None, typer.Option(help="file for a page with the distributions, as HTML")] = None,
    search: Annotated[
        str | None,
        typer.Option(help="check whose worst case is searched for, as 'experiment: name'"),
    ] = None,
    scheduler: Annotated[str | None, typer.Option(help="address of a dask scheduler, as tcp://host:8786")] = None,
    fresh: Fresh = False,
) -> None:
    """Run the experiments on many machines within their tolerances: distributions, yield, and what drives them."""
    from synth.app import study_command

    files = study_command.StudyFiles(csv, parquet, report)
    chosen = study_command.StudyChoice(
        plants, tuple(experiments or ()), seed, sampling.value, row, files, search, scheduler
    )
    raise typer.Exit(study_command.study(name, as_json, fresh, chosen))


@app.command(epilog="Example: synth compare my_stage my_other_stage --plants 1000 --report comparison.html")
def compare(
    first: Name,
    second: Name,
    as_json: AsJson = False,
    plants: Annotated[int, typer.Option(min=1, help="machines to draw; the first is the nominal one")] = 200,
    experiments: Annotated[
        list[str] | None, typer.Option(help="pattern of experiments' names; may be repeated")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="seed of the machines")] = 0,
    sampling: Annotated[
        Sampling, typer.Option(help="how machines are drawn within their tolerances")
    ] = Sampling.UNIFORM,
    report: Annotated[Path | None, typer.Option(help="file for a page with the tables, as HTML")] = None,
    fresh: Fresh = False,
) -> None:
    """Run two designs of one plant on the same machines: values, margins, instructions side by side. No verdicts."""
    from synth.app import comparison
    from synth.simulate import sampling as samplings

    drawn = samplings.Sampling(plants, seed, samplings.Method(sampling.value))
    chosen = comparison.CompareChoice(drawn, tuple(experiments or ()), report)
    raise typer.Exit(comparison.compare((first, second), as_json, fresh, chosen))


@app.command(epilog="Example: synth tune my_stage --plants 16 --report tuning.html")
def tune(
    name: Name,
    as_json: AsJson = False,
    plants: Annotated[int, typer.Option(min=1, help="machines of each candidate; the first is the nominal one")] = 8,
    seed: Annotated[int, typer.Option(min=0, help="seed of the machines and of the search")] = 0,
    generations: Annotated[int, typer.Option(min=1, help="generations of each of the three runs")] = 4,
    report: Annotated[Path | None, typer.Option(help="file for a page with the Pareto front, as HTML")] = None,
    chosen: Annotated[
        list[str] | None, typer.Option("--set", help="name=value on the bench, instead of a search: its margins")
    ] = None,
    write: Annotated[
        Path | None, typer.Option(help="file for the constants of --set, which the running loop takes")
    ] = None,
    bench: Annotated[
        bool, typer.Option("--bench", help="margins over the ranges of the bench, instead of a search")
    ] = False,
) -> None:
    """Search the free parameters of a law for values that reach the requirements: a proposal with its certificate.

    With --set or --bench: margins of values that are tuned on the running machine, and the file that it takes.
    """
    from synth.app import tune_command
    from synth.declare.tuning import Plan

    if write is not None and not chosen:
        raise typer.BadParameter("--write needs the values of --set")
    if chosen or bench:
        raise typer.Exit(tune_command.tune_on_bench(name, as_json, chosen or (), write))
    raise typer.Exit(tune_command.tune(name, as_json, tune_command.TuneChoice(Plan(plants, seed, generations), report)))


@app.command(epilog="Example: synth audit my_stage")
def audit(names: Names = None, as_json: AsJson = False, fresh: Fresh = False) -> None:
    """Recompute every published value: published, recomputed, verdict, why. No verdict fails the command."""
    from synth.app import commands

    raise typer.Exit(commands.audit(names or (), as_json, fresh))


@app.command(epilog="Example: synth emit my_stage --scalar float64 --out firmware")
def emit(
    name: Name,
    out: Annotated[Path, typer.Option(help="folder to write to")],
    scalar: Annotated[Scalar, typer.Option(help="scalar type of the C")] = Scalar.FLOAT32,
    by_casadi: Annotated[
        bool, typer.Option("--casadi", help="the .c by CasADi's own code generator, behind the same header")
    ] = False,
    fresh: Fresh = False,
) -> None:
    """Write a design's C, header, manifest, gains and vectors elsewhere, or in the other scalar type."""
    from synth.app import commands

    raise typer.Exit(commands.emit(name, out, scalar, fresh, by_casadi))


@app.command(epilog="Example: synth export my_stage --target linux --out loop && make -C loop rehearsal")
def export(
    name: Name,
    out: Annotated[Path, typer.Option(help="folder to write to")],
    target: Annotated[str, typer.Option(help="what the project runs on: linux, mcu or linuxcnc")] = "linux",
    fresh: Fresh = False,
) -> None:
    """Write a project around the emitted step that runs it: loop, set-points, commands, recorder, rehearsal."""
    from synth.app import commands

    raise typer.Exit(commands.export(name, target, out, fresh))


@app.command(epilog="Example: synth new my_stage && cd my_stage && synth build")
def new(name: Annotated[str, typer.Argument(help="the stage: small letters, digits and underscores")]) -> None:
    """Make a workspace with a one-axis levitator that builds at once; in a workspace, add such a stage to it."""
    from synth.app import commands

    raise typer.Exit(commands.new(name))
