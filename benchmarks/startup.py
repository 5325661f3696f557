"""Start-up time: `synth --help`, `import synth` and the imports of `synth emit`, compared with `import control`.

Each is a separate process, and all are started in turn. Figures are medians over the turns of wall clock and processor
time. The interpreter alone is the lower bound.
"""

import os
import subprocess
import sys
from dataclasses import dataclass
from statistics import median
from time import perf_counter

TURNS = 7
COMMANDS = {
    "the interpreter alone": "pass",
    "import synth": "import synth",
    "synth --help": "import sys; sys.argv = ['synth', '--help']; from synth.app.cli import main; main()",
    "the commands of synth": "import synth.app.commands",
    "import control": "import control",
}


@dataclass(frozen=True)
class Startup:
    """Medians in ms of the wall clock and of the processor, and the wall clock over that of `import control`."""

    name: str
    wall_ms: float
    processor_ms: float
    of_control: float


def measure(turns: int = TURNS) -> list[Startup]:
    """Return how long each process takes, over turns in which all are started."""
    runs = [{name: _time_script(script) for name, script in COMMANDS.items()} for _ in range(turns)]
    wall = {name: median(run[name][0] for run in runs) for name in COMMANDS}
    processor = {name: median(run[name][1] for run in runs) for name in COMMANDS}
    return [
        Startup(name, 1e3 * wall[name], 1e3 * processor[name], wall[name] / wall["import control"]) for name in COMMANDS
    ]


def _time_script(script: str) -> tuple[float, float]:
    start, before = perf_counter(), os.times()
    subprocess.run([sys.executable, "-c", script], stdout=subprocess.DEVNULL, check=True)
    after = os.times()
    children = after.children_user + after.children_system - before.children_user - before.children_system
    return perf_counter() - start, children


def main() -> None:
    """Print the table."""
    sys.stdout.write(f"{'process':<24}{'wall, ms':>10}{'processor, ms':>15}{'of import control':>20}\n")
    for s in measure():
        sys.stdout.write(f"{s.name:<24}{s.wall_ms:>10.0f}{s.processor_ms:>15.0f}{s.of_control:>20.2f}\n")


if __name__ == "__main__":
    main()
