"""Composition of Blocks by signal name: an output drives every input that has its name.

[ a ]--- w --->[ b ]--- u --->
  ^------ excess ----|

A cycle of signals is an algebraic loop unless a state breaks it. The search follows the signals in each expression, so
two Blocks may exchange signals in both directions, as above, if no signal depends on itself within a sample.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import casadi as ca

from synth import arguments
from synth.block import Block, ComputedSignal, Exprs, Safety
from synth.errors import WiringError
from synth.law import Function
from synth.signals import Signal, dimension, signal_names
from synth.timing import Discrete, common


@arguments.checked
def compose(name: str, blocks: Sequence[Block], *, inputs: Sequence[str], outputs: Sequence[str]) -> Block:
    """Wire `blocks` by signal name into one Block with the open `inputs` and the chosen `outputs`.

    Each state and constant is prefixed with the name of its Block: ``lag`` of ``filter_y`` becomes ``filter_y_lag``.

    Raises WiringError when there is no Block; when a signal has two drivers or different units; when an input of a
    Block has no driver and is not listed in `inputs`; when no Block needs a listed input or drives a listed output; for
    an algebraic loop, a name that two Blocks share, or a fault bit that two Blocks set; and for guards that latch after
    different numbers of bad samples. Raises SignalError for an input or output that is listed twice, and TimingError
    for different sample periods.
    """
    if not len(blocks):
        raise WiringError(f"'{name}': there is no Block to wire: give at least one")
    time = common(*(b.time for b in blocks))
    assert isinstance(time, Discrete)
    blocks = [_with_prefix(b) for b in blocks]
    driver = _drivers(blocks)
    open_inputs = _open_inputs(name, blocks, driver, inputs)
    _check_fault_bits(blocks, driver)
    symbol: dict[str, ca.SX] = {n: ca.SX.sym(n) for n in (*driver, *open_inputs)}
    definitions = {s: _substitute_inputs(b, symbol, [b.output[s]])[0] for s, b in driver.items()}
    resolved, computed = _resolve(blocks, definitions, symbol)
    for s in outputs:
        if s not in driver:
            raise WiringError(f"'{name}': no Block drives output '{s}': add a Block that does, or leave it out")
    signal_symbols, exprs_of_signals = [symbol[s] for s in resolved], list(resolved.values())
    states = tuple(s for b in blocks for s in b.states)
    next_state: dict[str, ca.SX] = {}
    for b in blocks:
        exprs = _substitute_inputs(b, symbol, [b.next[s.name] for s in b.states])
        next_state |= zip(
            (s.name for s in b.states),
            ca.substitute(exprs, signal_symbols, exprs_of_signals) if exprs else [],
            strict=True,
        )
    labels: list[tuple[str, ca.SX]] = []
    for b in blocks:
        exprs = _substitute_inputs(b, symbol, [e for _, e in b.labels])
        exprs = ca.substitute(exprs, signal_symbols, exprs_of_signals) if exprs else []
        labels += zip((n for n, _ in b.labels), exprs, strict=True)
    functions = [_compose_function(f, b, symbol, signal_symbols, exprs_of_signals) for b in blocks for f in b.functions]
    constants = tuple(c for b in blocks for c in b.constants)
    symbols = {s: symbol[s] for s in open_inputs} | {
        n: b.symbol[n] for b in blocks for n in _state_and_constant_names(b)
    }
    signals = {s.name: s for b in blocks for s in b.outputs}
    faults = tuple(f for b in blocks for f in b.faults)
    flags = [e for b in blocks for e in _substitute_inputs(b, symbol, [b.output[f.output] for f in b.faults])]
    flags = ca.substitute(flags, signal_symbols, exprs_of_signals) if flags else []
    return Block(
        name,
        "",
        time,
        tuple(open_inputs[s] for s in signal_names(open_inputs[s] for s in inputs)),
        tuple(signals[s] for s in signal_names(signals[s] for s in outputs)),
        states,
        constants,
        symbols,
        {s: resolved[s] for s in outputs} | dict(zip((f.output for f in faults), flags, strict=True)),
        next_state,
        computed,
        faults,
        _safety(name, blocks, {s: _origin(s, definitions, symbol) for s in outputs}),
        tuple(pair for b in blocks for pair in b.numbers),
        tuple(labels),
        tuple(f for b in blocks for f in b.failures),
        tuple(pair for b in blocks for pair in b.notes),
        tuple(functions),
    )


def _compose_function(
    of: Function, block: Block, symbol: Exprs, signal_symbols: Sequence[ca.SX], exprs_of_signals: Sequence[ca.SX]
) -> Function:
    """Return a function of a Block in states, constants and open inputs of the composition."""
    exprs = _substitute_inputs(block, symbol, [*of.arguments, *of.results])
    exprs = list(ca.substitute(exprs, signal_symbols, exprs_of_signals)) if exprs else []
    return replace(of, arguments=tuple(exprs[: len(of.arguments)]), results=tuple(exprs[len(of.arguments) :]))


def _origin(signal: str, definitions: Exprs, symbol: Exprs) -> str:
    """Follow a chain of copies back from `signal`, and return the first signal of it that a Block drives."""
    while definitions[signal].is_symbolic():
        by_hash = {symbol[s].element_hash(): s for s in definitions}
        source = by_hash.get(definitions[signal].element_hash())
        if source is None:
            break
        signal = source
    return signal


def _safety(name: str, blocks: Sequence[Block], origin: Mapping[str, str]) -> Safety | None:
    """Merge the `Safety` of the Blocks: safe values and slew rates of the outputs; `origin` maps outputs to signals."""
    declared = [(b.name, b.safety) for b in blocks if b.safety]
    if not declared:
        return None
    first, safety = declared[0]
    for other, s in declared:
        if s.bad_samples != safety.bad_samples:
            raise WiringError(
                f"'{name}': '{first}' latches after {safety.bad_samples} bad samples, '{other}' after {s.bad_samples}: "
                "declare one number for both"
            )
    values = {n: v for _, s in declared for n, v in s.safe_output.items()}
    rates = {n: v for _, s in declared for n, v in s.slew_per_s.items()}
    landed = {n: v for _, s in declared for n, v in s.landed_output.items()}
    effects = [s.safe_output_effect for _, s in declared if s.safe_output] or [safety.safe_output_effect]
    values, rates, landed = (
        {o: by_signal[s] for o, s in origin.items() if s in by_signal} for by_signal in (values, rates, landed)
    )
    judgement = next((s.judgement for _, s in declared if s.judgement), None)
    return Safety(
        safety.bad_samples,
        values,
        rates,
        "; ".join(dict.fromkeys(effects)),
        judgement,
        safety.braking,
        safety.good_samples,
        landed,
    )


def _with_prefix(block: Block) -> Block:
    """Return the Block with its name before each state and constant, so that two copies of a Block share no name."""
    prefixed = {n: f"{block.name}_{n}" for n in _state_and_constant_names(block)}
    symbol = {prefixed.get(n, n): s for n, s in block.symbol.items()}
    states = tuple(replace(s, signal=replace(s.signal, name=prefixed[s.name])) for s in block.states)
    constants = tuple(replace(c, name=prefixed[c.name]) for c in block.constants)
    next = {prefixed[n]: e for n, e in block.next.items()}
    return replace(block, symbol=symbol, states=states, constants=constants, next=next)


def _state_and_constant_names(block: Block) -> list[str]:
    """Return the names of the states and constants, which are not signals of the composition."""
    return [s.name for s in block.states] + [c.name for c in block.constants]


def _drivers(blocks: Sequence[Block]) -> dict[str, Block]:
    driver: dict[str, Block] = {}
    for b in blocks:
        for s in b.outputs:
            if s.name in driver:
                first = driver[s.name].name
                raise WiringError(f"signal '{s.name}' has two drivers, '{first}' and '{b.name}': rename one of them")
            driver[s.name] = b
    owners: dict[str, str] = {}
    for b in blocks:
        for n in _state_and_constant_names(b):
            if n in driver or n in owners:
                owner = owners.get(n) or driver[n].name
                raise WiringError(f"'{n}' of block '{b.name}' is also a name in '{owner}': rename one of the Blocks")
            owners[n] = b.name
    return driver


def _open_inputs(
    name: str, blocks: Sequence[Block], driver: Mapping[str, Block], listed: Sequence[str]
) -> dict[str, Signal]:
    open_inputs: dict[str, tuple[Signal, str]] = {}
    for b in blocks:
        for s in b.inputs:
            if s.name in driver:
                source = next(o for o in driver[s.name].outputs if o.name == s.name)
                _check_same_dimension(source, driver[s.name].name, s, b.name)
            elif s.name not in listed:
                raise WiringError(
                    f"signal '{s.name}' is needed by '{b.name}' but no Block drives it: "
                    f"add a Block that does, or list it among the inputs of '{name}'"
                )
            elif s.name in open_inputs:
                _check_same_dimension(*open_inputs[s.name], s, b.name)
            else:
                open_inputs[s.name] = (s, b.name)
    for n in listed:
        if n not in open_inputs:
            why = f"is driven by '{driver[n].name}'" if n in driver else "is needed by no Block"
            raise WiringError(f"'{name}': input '{n}' {why}: remove it from the inputs")
    for b in blocks:
        for n in _state_and_constant_names(b):
            if n in open_inputs:
                raise WiringError(f"input '{n}' is also a name in block '{b.name}': rename one of them")
    return {n: s for n, (s, _) in open_inputs.items()}


def _check_fault_bits(blocks: Sequence[Block], driver: Mapping[str, Block]) -> None:
    taken: dict[int, str] = {}
    for b in blocks:
        for f in b.faults:
            if f.bit in taken:
                raise WiringError(
                    f"fault bit {f.bit} is set by '{taken[f.bit]}' and by '{b.name}', and each numbers its own inputs: "
                    "guard all inputs in one Block"
                )
            if driver.get(f.output, b) is not b:
                raise WiringError(
                    f"flag '{f.output}' of '{b.name}' is also driven by '{driver[f.output].name}': rename one of them"
                )
            taken[f.bit] = b.name


def _check_same_dimension(first: Signal, first_block: str, second: Signal, second_block: str) -> None:
    if dimension(first.unit) != dimension(second.unit):
        raise WiringError(
            f"signal '{first.name}' is in {first.unit} in '{first_block}' but in {second.unit} in '{second_block}': "
            "convert it in a Block between them"
        )


def _substitute_inputs(block: Block, symbol: Exprs, exprs: Sequence[ca.SX]) -> list[ca.SX]:
    """Return a Block's expressions with its own input symbols replaced by the composition's."""
    if not block.inputs or not exprs:
        return list(exprs)
    old, new = [block.symbol[s.name] for s in block.inputs], [symbol[s.name] for s in block.inputs]
    return list(ca.substitute(list(exprs), old, new))


def _resolve(
    blocks: Sequence[Block], definitions: Exprs, symbol: Exprs
) -> tuple[dict[str, ca.SX], tuple[tuple[ComputedSignal, ca.SX], ...]]:
    """Express each driven signal in states, constants and open inputs, in the order of computation.

    Also return the internal signals of the Blocks with their expressions, each as soon as its inputs are available.
    """
    driven = {s: symbol[s] for s in definitions}
    needs = {s: sorted(_signals_in(e, driven)) for s, e in definitions.items()}
    order: list[str] = []
    path: list[str] = []

    def visit(signal: str) -> None:
        if signal in path:
            cycle = " <- ".join([*path[path.index(signal) :], signal])
            raise WiringError(f"algebraic loop {cycle}: put a state (one sample of delay) on one of these signals")
        if signal in order:
            return
        path.append(signal)
        for need in needs[signal]:
            visit(need)
        order.append(path.pop())

    for b in blocks:
        for s in b.outputs:
            visit(s.name)
    owner = {s.name: b for b in blocks for s in b.outputs}
    resolved: dict[str, ca.SX] = {}
    computed: list[tuple[ComputedSignal, ca.SX]] = []
    waiting = {b: [(n, e) for n, e in b.computed_signals if n.signal.name not in owner] for b in blocks}
    for signal in order:
        b = owner[signal]
        keys, values = [symbol[s] for s in resolved], list(resolved.values())
        ready = [pair for pair in waiting[b] if _input_names(b, pair[1]) & set(owner) <= set(resolved)]
        waiting[b] = [pair for pair in waiting[b] if all(pair is not r for r in ready)]
        exprs = [definitions[signal], *_substitute_inputs(b, symbol, [e for _, e in ready])]
        exprs = ca.substitute(exprs, keys, values) if keys else exprs
        resolved[signal] = exprs[0]
        computed += zip((n for n, _ in ready), exprs[1:], strict=True)
        computed.append((next(n for n, _ in b.computed_signals if n.signal.name == signal), exprs[0]))
    for b, remaining in waiting.items():  # internal signals that need a signal driven after all outputs of their Block
        exprs = _substitute_inputs(b, symbol, [e for _, e in remaining])
        exprs = ca.substitute(exprs, [symbol[s] for s in resolved], list(resolved.values())) if exprs else []
        computed += zip((n for n, _ in remaining), exprs, strict=True)
    return resolved, tuple(computed)


def _input_names(block: Block, expr: ca.SX) -> set[str]:
    """Return the names of the Block's inputs in `expr`."""
    return _signals_in(expr, {s.name: block.symbol[s.name] for s in block.inputs})


def _signals_in(expr: ca.SX, symbol: Exprs) -> set[str]:
    """Return the names of the symbols in `expr`; symbols are compared by identity, not by name."""
    present = {v.element_hash() for v in ca.symvar(expr)}
    return {name for name, s in symbol.items() if s.element_hash() in present}
