"""Software-in-the-loop execution of emitted C on the host: structs as NumPy records, steps in a compiled loop.

    state', out_k, faults_k = step(state, in_k),  k = 0 .. N-1

The manifest states the layout of each struct; compile-time assertions confirm it. Bits pass unchanged: a float32 array
for a float member is copied, which preserves the payload of a NaN.

Build a controller from a Block: emit its C, compile it and load it, in one call.
"""

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.block import Block
from synth.emit import write
from synth.errors import DesignError, SignalError, WiringError
from synth.execute import compile as host_compiler
from synth.execute import elf
from synth.signals import signal_names

Records = NDArray[np.void]
Columns = dict[str, NDArray[Any]]

SCALARS = {"float": np.float32, "double": np.float64, "uint32_t": np.uint32, "int32_t": np.int32}
_GLUE_FILE = "synth_host.c"
_GLUE = """{layout}
void synth_host_init({state} *state) {{ {init}(state); }}

uint32_t synth_host_step(void *state, const void *in, void *out) {{
    {state} *const s = state;
    const {input} *const i = in;
    {output} *const o = out;
    return {step}(s, i, o);
}}

void synth_host_steps(int64_t n, int64_t stride, {state} *state, const {input} *in, {output} *out, uint32_t *faults) {{
    for (int64_t k = 0; k < n; k++) faults[k] = {step}(state + k * stride, in + k, out + k);
}}
"""


class Step(NamedTuple):
    """One step: output values by name, and the fault bits."""

    outputs: dict[str, Any]
    faults: int


class Replay(NamedTuple):
    """N steps in a row: output columns (N,) by name, fault bits (N,), and the state after the last."""

    outputs: Columns
    faults: NDArray[np.uint32]
    state: Records


class Batch(NamedTuple):
    """One step from each of N states: output columns (N,) by name, fault bits (N,), and the states (N,) after it."""

    outputs: Columns
    faults: NDArray[np.uint32]
    states: Records


class Source(NamedTuple):
    """What C was emitted from: the Block, and the arguments `libm` and `error` of `write.emit`."""

    block: Block
    libm: bool
    error: float | None


@dataclass(frozen=True, eq=False)
class Controller:
    """Compiled C with the contract `init(state)`, `faults = step(state, in, out)`; `load` makes one.

    `inputs`, `outputs` and `state` are the structs as NumPy dtypes. A state is a record of shape (), owned by the
    caller: `state = controller.init(); state["xi"] = 0.5`. `source` is what the C was emitted from, where it is known.

    `base` is set for a variant, whose `source` is another Block with the same signals (`vary`): it runs in lanes
    alone, since the C is that of the base.
    """

    manifest: Mapping[str, Any]
    inputs: np.dtype[np.void]
    outputs: np.dtype[np.void]
    state: np.dtype[np.void]
    library: ctypes.CDLL
    source: "Source | None" = None
    base: "Controller | None" = None

    @property
    def period_s(self) -> float:
        """The sample period, seconds."""
        return float(self.manifest["period_s"])

    @property
    def scalar(self) -> type[np.float32] | type[np.float64]:
        """The type of every real member."""
        return np.float32 if self.manifest["scalar"] == "float32" else np.float64

    @property
    def status_mask(self) -> np.uint32:
        """The bits of the fault word that are no faults."""
        return np.uint32(sum(1 << f["bit"] for f in self.manifest.get("faults", ()) if f.get("status")))

    @property
    def step_address(self) -> int:
        """The address of `uint32_t step(void *state, const void *in, void *out)`."""
        return ctypes.cast(self.library.synth_host_step, ctypes.c_void_p).value or 0

    def init(self, changed: Mapping[str, float] = MappingProxyType({})) -> Records:
        """Return the state after `init`, a record of shape (), with the members in `changed` replaced.

        Raises SignalError for a member that the state does not have.
        """
        state = np.zeros((), self.state)
        _prototype(self.library, "synth_host_init", ctypes.c_void_p)(state.ctypes.data)
        for name, value in changed.items():
            if name not in (self.state.names or ()):
                known = ", ".join(self.state.names or ())
                raise SignalError(f"'{self.manifest['design']}' has no state '{name}': it has {known or 'none'}")
            state[name] = value
        return state

    def step(self, state: Records, inputs: Mapping[str, Any]) -> Step:
        """Advance `state` in place by one step.

        Raises SignalError when an input is missing or unknown, or when `state` is not of the type that `init` returns.
        """
        require_states(self.manifest, self.state, state, ())
        outputs, faults = self._advance(state, self.records(inputs, 1))
        return Step({name: outputs[name][0] for name in outputs.dtype.names or ()}, int(faults[0]))

    def replay(self, inputs: Mapping[str, ArrayLike], state: Records | None = None) -> Replay:
        """Run N steps from a copy of `state`, or from `init`; inputs are columns (N,) or constants.

        Raises SignalError as `step`, when the lengths of the columns differ, and when every input is a constant.
        """
        start = self.init() if state is None else state
        require_states(self.manifest, self.state, start, ())
        after = start.copy()
        outputs, faults = self._advance(after, self.records(inputs, length(inputs)))
        return Replay(columns(outputs), faults, after)

    def batch(self, states: Records, inputs: Mapping[str, ArrayLike]) -> Batch:
        """Take one step from a copy of each of the `states` (N,); inputs are columns (N,) or constants.

        Raises SignalError as `step`.
        """
        require_states(self.manifest, self.state, states, (np.size(states),))
        after = states.copy()
        outputs, faults = self._advance(after, self.records(inputs, len(after)))
        return Batch(columns(outputs), faults, after)

    def tune(self, state: Records, values: Mapping[str, float], left: int = 1) -> int:
        """Move the constants of the law in `state` to `values`, with `left` calls to go; return why not, 0 if they are.

        Raises SignalError for C without such constants, when a value is missing or unknown, and for another state.
        """
        if "tuning" not in self.manifest:
            raise SignalError(
                f"'{self.manifest['design']}' has no constants that change: declare a bench in its tuning"
            )
        require_states(self.manifest, self.state, state, ())
        parameters, pointer = self.parameters(values), ctypes.c_void_p
        move = ctypes.CFUNCTYPE(ctypes.c_uint32, pointer, pointer, ctypes.c_uint32)
        tune = move((self.manifest["tuning"]["functions"]["tune"], self.library))
        return int(tune(state.ctypes.data, parameters.ctypes.data, left))

    def parameters(self, values: Mapping[str, float]) -> Records:
        """Return the parameters with these values of the constants, and their check, a record of shape (1,).

        Raises SignalError when a value is missing or unknown.
        """
        struct = dtype("parameters", self.manifest)
        others = {n: 0.0 for n in struct.names or () if n not in self.manifest["tuning"]["default"]}
        filled = records(self.manifest, struct, {**values, **others}, 1)
        check = ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.c_void_p)
        filled["check"] = check((self.manifest["tuning"]["functions"]["check"], self.library))(filled.ctypes.data)
        return filled

    def records(self, inputs: Mapping[str, ArrayLike], n: int) -> Records:
        """Return n input structs from columns (n,) or constants by name.

        Raises SignalError when an input is missing or unknown, or when the length of a column is not n.
        """
        return records(self.manifest, self.inputs, inputs, n)

    def _advance(self, states: Records, inputs: Records) -> tuple[Records, NDArray[np.uint32]]:
        n = len(inputs)
        outputs, faults = np.zeros(n, self.outputs), np.zeros(n, np.uint32)
        run = _prototype(self.library, "synth_host_steps", *[ctypes.c_int64] * 2, *[ctypes.c_void_p] * 4)
        run(n, states.ndim, *(array.ctypes.data for array in (states, inputs, outputs, faults)))
        return outputs, faults


def load(files: Mapping[str, str], manifest: Mapping[str, Any], flags: Sequence[str] = ()) -> Controller:
    """Compile and load `{filename: text}` of emitted C with its `manifest`; `flags` come after the default ones.

    Files that are neither .c nor .h are ignored.

    Raises DesignError when the manifest is incomplete or a header is missing, and CompileError when the compiler
    refuses the C or finds a struct whose layout differs from the manifest.
    """
    dtypes = {role: dtype(role, manifest) for role in ("input", "output", "state")}
    library = host_compiler.shared_library({**code(files), _GLUE_FILE: _glue(files, manifest)}, flags)
    return Controller(manifest, dtypes["input"], dtypes["output"], dtypes["state"], ctypes.CDLL(str(library)))


def code(files: Mapping[str, str]) -> dict[str, str]:
    """Return the C files among emitted files: those that end in .c or .h."""
    return {name: text for name, text in files.items() if name.endswith((".c", ".h"))}


def dtype(role: str, manifest: Mapping[str, Any]) -> np.dtype[np.void]:
    """Return the struct "input", "output" or "state" of a manifest as a NumPy dtype.

    Raises DesignError when the manifest is incomplete.
    """
    try:
        struct = manifest["structs"][role]
        formats = [(SCALARS[f["ctype"]], (f["count"],) if f["count"] > 1 else ()) for f in struct["fields"]]
        names, offsets = ([f[key] for f in struct["fields"]] for key in ("name", "offset"))
        spec = {"names": names, "formats": formats, "offsets": offsets, "itemsize": struct["size"]}
        return np.dtype(spec)  # type: ignore[call-overload]
    except (KeyError, ValueError, TypeError) as error:
        raise DesignError(
            f"manifest, struct '{role}': {type(error).__name__} {error}; needed are type, size and, for each field, "
            f"name, offset, count and one ctype of {', '.join(SCALARS)}: emit the C again"
        ) from error


def records(manifest: Mapping[str, Any], struct: np.dtype[np.void], inputs: Mapping[str, ArrayLike], n: int) -> Records:
    """Return n input structs from columns (n,) or constants by name, as `Controller.records` does."""
    known = struct.names or ()
    missing, unknown = [k for k in known if k not in inputs], [k for k in inputs if k not in known]
    if missing or unknown:
        raise SignalError(
            f"inputs of '{manifest['design']}': missing {missing or 'none'}, not known {unknown or 'none'}: "
            f"give each of {', '.join(known)}"
        )
    filled = np.zeros(n, struct)
    for name, values in inputs.items():
        fill(filled, name, values)
    return filled


def require_states(
    manifest: Mapping[str, Any], struct: np.dtype[np.void], states: Records, shape: tuple[int, ...]
) -> None:
    """Raise SignalError unless `states` are writeable contiguous records of this struct and shape."""
    fits = isinstance(states, np.ndarray) and states.dtype == struct and states.shape == shape
    if not (fits and states.flags.c_contiguous and states.flags.writeable):
        raise SignalError(
            f"state of '{manifest['design']}': found {type(states).__name__} of shape {np.shape(states)}, "
            f"need a writeable contiguous one of shape {shape} and dtype `controller.state`: start from `init()`"
        )


def columns(records: Records) -> Columns:
    """Return each member of the records (N,) as a separate array (N,)."""
    return {name: records[name].copy() for name in records.dtype.names or ()}


def fill(records: Records, name: str, values: ArrayLike, where: NDArray[np.bool_] | None = None) -> None:
    """Write a column (N,) or a constant into member `name` of the records (N,), or only where `where` is true.

    Raises SignalError when the column's length is not N.
    """
    column = records[name]
    samples = np.asarray(values)
    if samples.shape not in ((), column.shape[1:], column.shape):
        raise SignalError(
            f"samples of '{name}': found the shape {samples.shape}, need {column.shape}: give one value for each sample"
        )
    # A value too large for float32 becomes infinite on purpose: an injected fault may have any size.
    with np.errstate(over="ignore", invalid="ignore"):
        typed = np.broadcast_to(samples.astype(column.dtype), column.shape)
    if where is None:
        column[...] = typed
    else:
        column[where] = typed[where]


def length(inputs: Mapping[str, ArrayLike]) -> int:
    """Return the length N of the input columns (N,); constants are ignored.

    Raises SignalError when the lengths of the columns differ, and when every input is a constant.
    """
    lengths = {name: len(np.asarray(values)) for name, values in inputs.items() if np.ndim(values)}
    if len(set(lengths.values())) != 1:
        raise SignalError(f"inputs have the lengths {lengths}: give columns of one length, at least one of them")
    return next(iter(lengths.values()))


def _prototype(library: ctypes.CDLL, name: str, *arguments: type) -> Any:
    return ctypes.CFUNCTYPE(None, *arguments)((name, library))


def _glue(files: Mapping[str, str], manifest: Mapping[str, Any]) -> str:
    structs = manifest["structs"]
    return _GLUE.format(
        layout=elf.assertions(files, manifest),
        init=manifest["functions"]["init"],
        step=manifest["functions"]["step"],
        **{role: structs[role]["type"] for role in structs},
    )


def compile_block(
    block: Block,
    scalar: type[np.floating] = np.float32,
    *,
    error: float | None = None,
    libm: bool = False,
) -> Controller:
    """Return the emitted C of a Block in a scalar type, compiled and loaded; arguments are those of `write.emit`.

    It accepts any DC gain: what the scalar type does to it shows.

    Raises EmitError as `write.emit`, and CompileError as `load`.
    """
    emitted = write.emit(block, scalar, libm=libm, error=error, gain_error=np.inf)
    loaded = load(emitted.files, emitted.manifest)
    return replace(loaded, source=Source(block, libm, error))


def vary(base: Controller, block: Block) -> Controller:
    """Return a variant of a controller, such as one with other gains, that runs in lanes without a compilation of C.

    Raises WiringError for a base whose Block is not known, and for a Block with other signals or initial states.
    """
    if base.source is None:
        raise WiringError(f"controller '{base.manifest['design']}' has no Block: make it with build.compile_block")
    if _interface(block) != _interface(base.source.block):
        raise WiringError(
            f"the variant of controller '{base.manifest['design']}' has other signals, states or initial values: "
            "a variant may differ in gains, bounds and equations alone"
        )
    return replace(base, source=base.source._replace(block=block), base=base.base or base)


def _interface(block: Block) -> tuple[object, ...]:
    states = tuple((s.name, s.initial, s.integer) for s in block.states)
    return block.name, block.time, signal_names(block.inputs), signal_names(block.outputs), states
