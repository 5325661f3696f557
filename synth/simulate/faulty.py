"""Faults inside the simulated loop: lagging sensors, actuators with a wrong gain, and missed calls of the controller.

    sensor    m_k = reading_{k - lag_k}                                    0 <= lag_k <= k
    word      m_k = low + step ((w_k ^ flipped_k | set_k) & ~cleared_k)    w_k = round((reading_k - low) / step)
    actuator  u_j(t) = gain_k (M c_{k-delay})_j + bias_k + forcing_j(t)    of each input that an actuator drives
    call      c_k = c_{k-1}, the state and the fault word stay             in a missed sample, except the first

    count     n_k = n_{k-1} + 1 after a missed sample, else 0              `Rig` gives it to a controller that reads it

A lag that grows by one in each sample freezes a reading; a constant one makes it late. Sensors that show samples of
their own are `Scenario.overrides`, and disturbed ones `Scenario.noise`.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.errors import SignalError
from synth.plant import Plant
from synth.simulate.scenario import Array, Scenario

Arrays = dict[str, NDArray[Any]]


def arrays(plant: Plant, scenario: Scenario, n: int) -> Arrays:
    """Return the arrays of `loop_t` for the faults of a scenario of n samples; a group without a fault has none.

    Raises SignalError for an unknown name, a wrong number of values, or a lag from before the start.
    """
    return _lags(scenario, n) | _words(scenario, n) | _input_faults(plant, scenario, n) | _missed_calls(scenario, n)


def _lags(scenario: Scenario, n: int) -> Arrays:
    if not scenario.lags:
        return {}
    sensors, k = list(scenario.sensors), np.arange(n)
    lags = np.zeros((n, len(sensors)), dtype=np.int64)
    for name, values in scenario.lags.items():
        _require("lags", name, sensors)
        lags[:, sensors.index(name)] = column = _column("lags", name, values, n)
        if (column < 0).any() or (column > k).any() or (column % 1).any():
            raise SignalError(
                f"lags of '{name}' are {column.min():g} .. {column.max():g}: give whole numbers from 0 to the number "
                "of the sample"
            )
    return {"sensor_lag": lags, "readings": np.zeros((n, len(sensors)))}


def _words(scenario: Scenario, n: int) -> Arrays:
    if not scenario.words:
        return {}
    sensors = list(scenario.sensors)
    low, step = np.zeros(len(sensors)), np.ones(len(sensors))
    masks = np.zeros((3, n, len(sensors)), dtype=np.int64)
    for name, word in scenario.words.items():
        _require("words", name, sensors)
        if not (np.isfinite(word.low) and 0 < word.step < np.inf):
            raise SignalError(
                f"word of '{name}' counts from {word.low} in steps of {word.step}: give a finite start and a step > 0"
            )
        i = sensors.index(name)
        low[i], step[i] = word.low, word.step
        for mask, bits in zip(masks, (word.flipped, word.set_bits, word.cleared), strict=True):
            mask[:, i] = _column("bits of the word", name, bits, n)
    return {"word_low": low, "word_step": step, "flipped": masks[0], "set_bits": masks[1], "cleared": masks[2]}


def _input_faults(plant: Plant, scenario: Scenario, n: int) -> Arrays:
    if not scenario.input_faults:
        return {}
    inputs = [s.name for s in plant.inputs]
    gain, bias = np.ones((n, len(inputs))), np.zeros((n, len(inputs)))
    for name, fault in scenario.input_faults.items():
        _require("input_faults", name, scenario.actuators)
        gain[:, inputs.index(name)] = _column("gain", name, fault.gain, n)
        bias[:, inputs.index(name)] = _column("bias", name, fault.bias, n)
    return {"input_gain": gain, "input_bias": bias}


def missed_counts(missed: NDArray[np.bool_]) -> Array:
    """Return for each sample (N,) the number of calls that are missing between the last one and this sample."""
    k = np.arange(len(missed))
    calls = np.maximum.accumulate(np.where(missed, 0, k))  # the last call up to each sample; the first is never missed
    return np.asarray(k - 1 - np.concatenate([[-1], calls[:-1]]), dtype=np.float64)


def _missed_calls(scenario: Scenario, n: int) -> Arrays:
    if scenario.missed is None:
        return {}
    missed = np.asarray(scenario.missed)
    if missed.dtype != np.bool_ or missed.shape != (n,):
        raise SignalError(f"missed is {missed.dtype} {missed.shape}: give {n} booleans, one a sample")
    return {"missed": missed.astype(np.uint8)}


def _require(what: str, name: str, known: Any) -> None:
    if name not in known:
        raise SignalError(f"{what}: '{name}' is not one of {', '.join(known) or '(none)'}: correct the name")


def _column(what: str, name: str, values: ArrayLike, n: int) -> NDArray[np.float64]:
    column = np.asarray(values, dtype=np.float64)
    if column.shape not in ((), (n,)) or not np.isfinite(column).all():
        raise SignalError(f"{what} of '{name}' is {column.shape}: give one finite number, or {n}, one a sample")
    return np.broadcast_to(column, (n,))
