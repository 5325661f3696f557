"""Simulated planar stage in the true field, with its loop closed by the estimate or by the stage's own sections.

    pose --> truth field --> 200 Hz filter --> + 1 mV --> 16 bits over +-5 V --> controller --> z^-delay --> currents
        '--> laser distances + noise --> 16 bits ------------------'

Both sources drive the regulators of planar_6dof_lqg, as compiled C in single precision. The sections are calibrated for
another amplitude of the field: the gain of their sensors is scaled by `gain_ratio`, as on a bench.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from designs.planar_6dof import interface, lqg
from designs.planar_6dof import loop as planar
from designs.planar_6dof.sensing import calibration as hall_calibration
from models import hall_chain, planar_stage
from studies.hall import built_matrix, hall_bench
from studies.hall.hall_bench import Bench
from studies.hall.loop import calibration, closed_loop
from studies.hall.loop.closed_loop import PoseSource
from synth import stage
from synth.block import Block, unranged
from synth.blocks.guard import safety
from synth.composition import compose
from synth.declare.stage import Interface
from synth.emit import write
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.plant import Plant
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory, sample_times
from synth.statespace import Array

TIME = lqg.TIME
RAW = {axis: f"{axis}_raw" for axis in closed_loop.HORIZONTAL}


@dataclass(frozen=True, eq=False)
class Loop:
    """A rig with Hall sensors at the bench's positions, whose voltages are those of the bench times `gain_ratio`.

    `view` is the part of its controller from the voltages to the raw position.
    """

    rig: Rig
    bench: Bench
    emitted: EmittedCode
    view: host.Controller
    gain_ratio: float = 1.0

    def run(
        self,
        duration_s: float,
        references: Mapping[str, ArrayLike],
        start: Mapping[str, float] | None = None,
        **options: Any,
    ) -> Trajectory:
        """Simulate from rest at `start` by axis (m, rad); set-points not in `references` stay there.

        The raw position that the controller computes is added to the outputs, as x_raw, y_raw and phi_raw.
        """
        noise = self._noise(len(sample_times(duration_s, TIME.period_s))) if self.rig.noise else {}
        start = {**(start or {}), **self._filter_states(start or {})}
        run = planar.simulate(self.rig, duration_s, references, start, noise=noise, **options)
        seen = self.view.replay(run.measured).outputs
        return replace(run, outputs=dict(run.outputs) | {name: np.asarray(v, np.float64) for name, v in seen.items()})

    def _filter_states(self, start: Mapping[str, float]) -> dict[str, float]:
        """Return the filters' states for a platen at rest, V."""
        pose = np.array([[start.get(axis, 0.0) for axis in closed_loop.HORIZONTAL]])
        volts = self.gain_ratio * hall_bench.static_voltages(self.bench, pose)[0]
        return {f"filtered_{n}": float(v) for n, v in zip(self.hall, volts, strict=True)}

    @property
    def hall(self) -> tuple[str, ...]:
        """The names of the Hall voltages."""
        return self.rig.stage.interface.suspected

    def _noise(self, n: int) -> dict[str, Array]:
        volts = hall_chain.noise(self.bench.chain, TIME, (len(self.hall), n), self.rig.seed)
        laser_noise = np.random.default_rng(self.rig.seed + 1).standard_normal((len(planar_stage.LASERS), n))
        rows = (*volts, *(interface.LASER_NOISE * laser_noise))
        return dict(zip((*self.hall, *planar_stage.LASERS), rows, strict=True))


def of_source(source: PoseSource, bench: Bench, gain_ratio: float = 1.0, libm: bool = False) -> Loop:
    """Return the loop with a source; with `libm` the C calls the library's sines, which makes emission faster."""
    plant, declared = planar_stage.plant(), interface.of_plant(_true_plant(bench, gain_ratio), source.held)
    block = closed_loop.controller(lqg.NAME, plant, TIME, lqg.law(plant), source, declared)
    error = closed_loop.SURROGATE_ERROR[np.float32]
    return _loop(bench, block, view(source, declared), error, libm, gain_ratio, declared)


def of_sections(libm: bool = False) -> Loop:
    """Return the loop with the sections of the stage's own sensors."""
    plant = planar_stage.plant()
    bench = Bench(planar_stage.hall_places(plant))
    gain_ratio = hall_calibration.of(plant).amplitude / calibration.array(bench).alpha
    shown = planar.position_block(TIME, predicted=False)
    error = interface.SURROGATE_ERROR[np.float32]
    return _loop(bench, lqg.controller(plant), shown, error, libm, gain_ratio, interface.INTERFACE)


def view(source: PoseSource, declared: Interface) -> Block:
    """Return the Block from voltages to the raw position, with the uncorrected estimate and its flags."""
    inputs = stage.guarded_inputs(declared)
    guard = safety.guard(TIME, inputs, interface.BAD_SAMPLES, suspected=declared.suspected)
    outputs = [*RAW.values(), "X", "Y", "yaw", "valid", *source.shown]
    parts = [guard, *closed_loop.position_blocks(source, TIME)]
    return unranged(compose("hall_view", parts, inputs=[g.signal.name for g in inputs], outputs=outputs))


def _true_plant(bench: Bench, gain_ratio: float) -> Plant:
    gain = gain_ratio * bench.chain.gain
    return built_matrix.plant(bench.places, bench.true, bench.chain, gain, bench.mountings)


def _loop(
    bench: Bench, block: Block, shown: Block, error: float, libm: bool, gain_ratio: float, declared: Interface
) -> Loop:
    emitted = write.emit(block, np.float32, libm=libm, error=error)
    controller = host.load(emitted.files, emitted.manifest)
    rig = replace(planar.of(block, controller, declared), plant=_true_plant(bench, gain_ratio))
    step = bench.chain.step
    converted = tuple(replace(s, resolution=step) if s.name in declared.suspected else s for s in declared.sensors)
    seen = host.compile_block(shown, np.float32, libm=libm, error=error)
    return Loop(rig.with_interface(sensors=converted), bench, emitted, seen, gain_ratio)
