"""Calibration of a measurement model y = h(q, k) + v from a scan with a reference measurement of q.

    fit        minimise sum_j |y_j - h_j(q, k)|^2 / w_j^2 over the free parameters k,   w_j^2 = n_j^2 + r_j^2
    reference  r_j^2 = mean over the scan of (dh_j/dq Q dh_j/dq')      its noise Q, as it acts on channel j
    held out   m_j^2 = U_j - w_j^2, at least 0,   U_j = sum e_j^2 / chi2_N(5 %)     N samples that were not fitted
    budget     m_j^2 + (d rms h_j)^2                                   d: relative drift of gains since the scan

n_j is the noise of channel j, and e_j its residual with the parameters of the fit. U_j is the upper 95 % bound of the
variance of residuals if they are independent. Neighbouring samples of a model error are not: hold out samples that are
further apart than the error is wide. The residuals of the fitted scan itself are too small, give `assess` another one.
`glsdc_model.covariance` makes R from noise and budget.

Source: JCGM 100 (GUM), 5.1 (propagation) and 4.2 (repeated observations); Hastie, Tibshirani, Friedman, "The Elements
of Statistical Learning", section 7.2 (error of a test sample).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy import stats

from synth import arguments, numeric, show
from synth import law as laws
from synth.base import column_maps
from synth.block import Constant, Exprs
from synth.errors import ModelError, SignalError
from synth.signals import Parameter, signal_names
from synth.statespace import Array, readonly
from synth.synthesise.identify import gauss_newton
from synth.synthesise.identify.estimates import Estimate
from synth.synthesise.identify.logs import Log

BOUND = 0.95  # probability of the upper bound of a variance
Measurement = Callable[[Exprs, Exprs], Exprs]


@dataclass(frozen=True, eq=False)
class Channels:
    """The measurement `h`, with the standard deviations of `references` (q) and `readings` (y) by name."""

    h: Measurement
    parameters: tuple[Parameter, ...]
    references: Mapping[str, float]
    readings: Mapping[str, float]
    function: ca.Function  # q (n,), k (p,) -> h (m,), dh/dk (m, p), dh/dq (m, n)

    def evaluate(self, log: Log, values: Array) -> tuple[Array, Array, Array]:
        """Return h (N, m), dh/dk (N, m, p) and dh/dq (N, m, n) for the rows of a log."""
        q, (N, m) = log.columns(tuple(self.references)), (len(log), len(self.readings))
        h, *slopes = column_maps.map_columns(self.function, q.T, values[:, None])
        by_k, by_q = (each.reshape(m, N, -1).transpose(1, 0, 2) for each in slopes)
        return h.T, by_k, by_q

    def deviations(self, by_q: Array) -> Array:
        """Return w (m,): noise of the readings, and of the references as it acts on them."""
        spread = np.array(list(self.references.values()))
        return np.sqrt(np.array(list(self.readings.values())) ** 2 + ((by_q * spread) ** 2).sum(axis=2).mean(axis=0))


@show.result
class Calibration:
    """Every parameter by name in `values`, of which `estimate` has the free ones; `steps` of the minimisation."""

    channels: Channels
    values: Mapping[str, float]
    estimate: Estimate
    steps: int

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters with their calibrated values: the start of a further stage."""
        return tuple(
            Parameter(p.name, self.values[p.name], p.unit, p.tolerance, p.source) for p in self.channels.parameters
        )

    @property
    def constants(self) -> tuple[Constant, ...]:
        """The parameters as constants of a Block, for an estimator with the same h."""
        return tuple(Constant(p.name, p.value, p.unit, "calibration") for p in self.parameters)

    def residuals(self, log: Log) -> Array:
        """Return y - h (N, m) of a log with the references and the readings."""
        h, _, _ = self.channels.evaluate(log, np.array(list(self.values.values())))
        return readonly(log.columns(tuple(self.channels.readings)) - h)

    def sheet(self) -> show.Sheet:
        """Return the sheet of the estimate."""
        return self.estimate.sheet()


@show.result
class Assessment:
    """By channel: residual `rms`, the part of it `explained` by noise, the `model_error` left, and the `size` of h."""

    rms: Mapping[str, float]
    explained: Mapping[str, float]
    model_error: Mapping[str, float]
    size: Mapping[str, float]
    samples: int

    def budget(self, gain_drift: float = 0.0) -> list[float]:
        """Return the model error of each channel with a relative drift of its gain since the calibration, rms.

        Raises ModelError for a drift that is negative or not finite.
        """
        drift = numeric.number("the drift of gains", gain_drift)
        if drift < 0:
            raise ModelError(f"the drift of gains is {drift}: give its rms relative to the gain, at least 0")
        return [float(np.hypot(self.model_error[name], drift * size)) for name, size in self.size.items()]

    def sheet(self) -> show.Sheet:
        """Return the table of channels."""
        columns = ("channel", "residual rms", "explained by noise", "model error, at most", "rms of h")
        parts = (self.rms, self.explained, self.model_error, self.size)
        rows = tuple((name, *(show.number(part[name], 3) for part in parts)) for name in self.rms)
        return show.Sheet(f"Residuals of {self.samples} samples", (), (show.Table("", columns, rows),))


@arguments.checked
def calibrate(
    h: Measurement,
    scan: Log,
    parameters: Sequence[Parameter],
    *,
    references: Mapping[str, float],
    readings: Mapping[str, float],
    free: Sequence[str] | None = None,
) -> Calibration:
    """Return the fit of the `free` parameters, all of them unless given, to a scan; each starts at its value.

    `h` maps the coordinates q and the parameters k by name to a value for each channel. The scan contains the
    `references`, which measure q, and the `readings`, which h predicts; each name has its standard deviation. A second
    stage starts from ``parameters`` of the first.

    Raises SignalError for an h that does not return a value for each reading, a free name that is no parameter, or a
    signal that the scan does not contain; ModelError for deviations that are not positive, or 0 in a reference at
    least, and as `gauss_newton.minimise`, as where the scan does not determine a parameter.
    """
    names = signal_names(parameters)
    chosen = names if free is None else arguments.distinct("free parameters", free)
    if strangers := [name for name in chosen if name not in names]:
        raise SignalError(f"the free parameter '{strangers[0]}' is none of {', '.join(names)}: declare it")
    of = _channels(h, tuple(parameters), _deviations(references, 0.0), _deviations(readings, None))
    start, index = np.array([p.value for p in parameters]), [names.index(name) for name in chosen]

    def complete(theta: Array) -> Array:
        values = start.copy()
        values[index] = theta
        return values

    def model(theta: Array) -> tuple[Array, Array]:
        values, slopes, _ = of.evaluate(scan, complete(theta))
        return values, slopes[:, :, index]

    y = scan.columns(tuple(readings))
    noise = dict(zip(readings, of.deviations(of.evaluate(scan, start)[2]).tolist(), strict=True))
    units = {p.name: p.unit for p in parameters}
    fit = gauss_newton.minimise(model, y, start[index], chosen, tuple(readings), noise, units=units)
    values = dict(zip(names, complete(fit.theta).tolist(), strict=True))
    return Calibration(of, values, fit.estimate, fit.steps)


@arguments.checked
def assess(calibration: Calibration, held_out: Log, corrections: Array | None = None) -> Assessment:
    """Return the residuals of samples that were not fitted, less what the noise explains.

    `corrections` (N, m) are added to h, as from a map of what the calibration left (`blocks.residual_map`).

    Raises SignalError for a signal that the log does not contain, or corrections of another shape.
    """
    of, N = calibration.channels, len(held_out)
    h, _, by_q = of.evaluate(held_out, np.array(list(calibration.values.values())))
    if corrections is not None:
        added = arguments.real("corrections", corrections)
        if added.shape != h.shape:
            raise SignalError(f"the corrections are {added.shape}: give one for each residual, {h.shape}")
        h = h + added
    squares = ((held_out.columns(tuple(of.readings)) - h) ** 2).sum(axis=0)
    explained = of.deviations(by_q)
    left = np.sqrt(np.maximum(squares / stats.chi2.ppf(1 - BOUND, N) - explained**2, 0))
    parts = np.sqrt(squares / N), explained, left, np.sqrt((h**2).mean(axis=0))
    rms, noise, error, size = (dict(zip(of.readings, part.tolist(), strict=True)) for part in parts)
    return Assessment(rms, noise, error, size, N)


def _deviations(of: Mapping[str, float], least: float | None) -> dict[str, float]:
    """Return standard deviations by name, above 0, or from `least` on."""
    if not isinstance(of, Mapping) or not of:
        raise SignalError(f"standard deviations are {arguments.describe(of)}: give one by name for each signal")
    deviations = {str(name): numeric.number(f"the deviation of '{name}'", value) for name, value in of.items()}
    for name, value in deviations.items():
        if value < 0 or (least is None and value == 0):
            raise ModelError(f"the deviation of '{name}' is {value}: give that of its noise, above 0")
    return deviations


def _channels(
    h: Measurement, parameters: tuple[Parameter, ...], references: dict[str, float], readings: dict[str, float]
) -> Channels:
    q, k = ({n: ca.SX.sym(n) for n in names} for names in (references, signal_names(parameters)))
    known = laws.NamedSymbols("h: the coordinates", q), laws.NamedSymbols("h: the parameters", k)
    values = laws.evaluate("h", h, *known)
    if not isinstance(values, Mapping):
        raise SignalError(f"h returns {arguments.describe(values)}: return a mapping of each channel to its value")
    laws.require_names("h", list(readings), values)
    exprs = laws.scalars("h", {n: values[n] for n in readings})
    laws.check_symbols("h", list(exprs.values()), [*q.values(), *k.values()])
    laws.check_numbers("h", exprs, [*q.values(), *k.values()])
    column, at, by = ca.vcat(list(exprs.values())), ca.vcat(list(q.values())), ca.vcat(list(k.values()))
    slopes = [ca.densify(ca.jacobian(column, v)) for v in (by, at)]
    return Channels(h, parameters, references, readings, ca.Function("channels", [at, by], [column, *slopes]))
