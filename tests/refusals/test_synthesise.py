"""Refusals of synth.synthesise: what a cost, a log or a compensator must have."""

from dataclasses import replace

import casadi as ca
import numpy as np

from models import maglev_stage
from synth.analyse import discretise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.classical import lead_lag
from synth.synthesise.classical.lead_lag import Compensator
from synth.synthesise.feedback import inverse_lqr, lqr, pole_placement
from synth.synthesise.identify import calibration, gauss_newton, identify, least_squares, logs
from synth.synthesise.identify.logs import Log
from synth.synthesise.nonlinear import feedback_linearisation
from synth.timing import Continuous, Discrete
from tests import textbook_plants
from tests.refusals.table import call, refusals
from tests.synthesise.mass_spring import DAMP, MASS, SPRING, run, stage

C, D, T = Continuous(), Discrete(0.1), 1e-3
ONE = ([[-1.0]], [[1.0]])
DOUBLE = StateSpace([[0, 1], [0, 0]], [[0], [1]], np.eye(2), np.zeros((2, 1)), ("x", "v"), ("u",), ("x", "v"), C)
SAMPLED = discretise.zero_order_hold(DOUBLE, 0.1)
RNG = np.random.default_rng(7)
THIRD = (RNG.normal(size=(3, 3)), RNG.normal(size=(3, 1)))
LQR_GAIN = lqr.lqr(DOUBLE, [1, 1], [1])
V = ca.SX.sym("v", 2)
Q = ca.SX.sym("q", 2)
FORCED = {"inputs": {"v0": V[0], "v1": V[1]}, "w": [ca.SX.sym("w0"), ca.SX.sym("w1")]}
MOVES = {"x": ca.SX.sym("x"), "v": ca.SX.sym("v"), "a": ca.SX.sym("a"), "f": ca.SX.sym("f")}
SPRUNG = {p.name: ca.SX.sym(p.name) for p in (MASS, DAMP, SPRING)}
FORCE = SPRUNG["m"] * MOVES["a"] + SPRUNG["d"] * MOVES["v"] + SPRUNG["k"] * ca.sin(MOVES["x"]) - MOVES["f"]
LINEAR = {"log": Log({n: [1.0] * 4 for n in MOVES}), "signals": MOVES}
LINEAR |= {"parameters": (MASS, DAMP, SPRING), "symbols": SPRUNG}
FREE = run({"m": 2.0, "d": 3.0, "k": 40.0}, [0.05, 0.0], 6, 1e-3)
STAGE_FIT = {"plant": stage(), "log": FREE, "parameters": ("k",), "measured": ("s",)}


MODEL = [
    *(
        call(inverse_lqr.diagonal_weights, part, system=DOUBLE, poles=poles)
        for poles, part in (
            ([-1, 3], "no weights give the pole 3+0j: an optimal loop has none with Re >= 0"),
            ([2j, -2j], "Re >= 0"),
            ([-0.1 + 3j, -0.1 - 3j], "need the weight -17.98 on v, but LQR takes none below 0"),
        )
    ),
    call(inverse_lqr.diagonal_weights, "none with |z| >= 1", system=([[0.5]], [[1]], D), poles=[-1]),
    call(pole_placement.place, "0 does not decay: ask for poles with a negative real", system=THIRD, poles=[-1, -2, 0]),
    call(pole_placement.place, "pole 1 does not decay: ask for poles with |z| < 1", system=SAMPLED, poles=[1, 0.5]),
    call(lqr.cost_ratio, "the optimal cost is zero", system=ONE, gain=lqr.lqr(ONE, [0], [1]), Q=[0], R=[1]),
    call(calibration.calibrate, "deviation of 'b' is 0", references={"a": 0.0}, readings={"b": 0.0}),
    *(
        call(identify.fit_linear, f"'force' is not linear in {name}: multiply it out", equations={"force": e}, **LINEAR)
        for e, name in (
            (SPRUNG["m"] * SPRUNG["d"] * MOVES["v"] + SPRUNG["k"] * MOVES["x"], "m, d"),
            (SPRUNG["m"] * MOVES["a"] + ca.exp(SPRUNG["k"] * MOVES["x"]), "k"),
        )
    ),
    call(
        identify.fit_equations,
        "not finite at m = 0: give parameters that divide a value other than 0",
        plant=stage().with_parameters(m=0.0),
        log=FREE,
        parameters=("m",),
        rates={},
    ),
    *(
        call(feedback_linearisation.linearise, part, acceleration=acceleration, **FORCED)
        for acceleration, part in (
            ([V[0]], "1 accelerations and 2 demands meet 2 inputs (v0, v1)...combine or drop"),
            ([V[0] + V[1] ** 2, V[1]], "not affine in 'v1'...drop or invert"),
            ([V[0] * V[1], V[1]], "not affine in 'v"),
            ([ca.sin(V[0]), V[1]], "not affine in 'v0'"),
            ([V[0], Q[0] * V[0]], "(v0, v1) is singular everywhere, as sampled"),
            ([Q[0] * (V[0] + 2 * V[1]), Q[1] * (V[0] + 2 * V[1])], "singular everywhere"),
            ([ca.sin(Q[0]) * V[0], ca.cos(Q[0]) * V[0] + 0 * V[1]], "singular everywhere"),
            ([Q[0], Q[1] * V[1]], "singular everywhere"),
        )
    ),
    *(
        call(feedback_linearisation.of_plant, part, plant=plant, point=None)
        for plant, part in (
            (textbook_plants.ball_and_beam(-1.0), "degree of 'y' is not defined at r = 0 m"),
            (textbook_plants.unicycle(), "that of 'py' on 'px'...Make inputs states"),
            (textbook_plants.with_integrators(textbook_plants.unicycle(), ["v"]), "singular ...at v = 0 m/s: shrink"),
            (maglev_stage.plant(), "not affine in its inputs: the rate of 'vy' in i_d1"),
        )
    ),
    call(
        lqr.lqr,
        "R + B'XB is singular: the cost does not distinguish the inputs u1, u2",
        system=([[2.0]], np.ones((1, 2)), D),
        Q=[1.0],
        R=np.zeros((2, 2)),
    ),
]
SIGNAL = [
    call(Compensator, "2 zeros but 1 poles, ...add a filter pole", zeros=(-1.0, -2.0), poles=(0.0,)),
    call(Compensator, "gain is 0", gain=0.0),
    *(
        call(lead_lag.from_time_constants, "the time constant ...is not positive", denominator_constants_s=[constant])
        for constant in (0.0, -0.1)
    ),
    call(
        lead_lag.tustin,
        "200 1/s is mapped to infinity by the method tustin",
        compensator=Compensator(1, (200.0,), (-1.0,)),
    ),
    *(
        call(inverse_lqr.diagonal_weights, part, system=DOUBLE, poles=poles)
        for poles, part in (
            ([-1 + 1j, -2], "conjugate pairs"),
            ([-1], "need a model of 1 input, with states, and 2 finite poles: found 1 inputs and poles [-1]"),
            ([np.nan, -1], "2 finite poles"),
        )
    ),
    call(inverse_lqr.diagonal_weights, "1 input", system=([[0.5]], [[1, 1]]), poles=[-1]),
    *(call(inverse_lqr.diagonal_weights, " R ", system=DOUBLE, R=R) for R in (0, -1.0)),
    *(
        call(pole_placement.place, part, system=THIRD, poles=poles)
        for poles, part in (
            ([-1, -2], "number of poles for x1, x2, x3 is 2: give 3"),
            ([-1, -2 + 1j, -3], "pole -2+1i has no conjugate"),
            ([-1, -2 + 1j, -2 - 1.1j], "pole -2+1i has no conjugate"),
            ([-1, -2, -2 - 1j], "pole -2-1i has no conjugate"),
            ([-1, -2, np.nan], "give a list of finite numbers"),
        )
    ),
    call(lqr.lqrd, "Q is not symmetric", Q=[[1, 1], [0, 1]]),
    call(lqr.lqrd, "matrix R is", R=np.eye(2)),
    call(
        lqr.cost_ratio,
        "the gain is from x1 to u1, the model has the states x, v",
        system=DOUBLE,
        gain=lqr.lqr(ONE, [1], [1]),
    ),
    call(lqr.cost_ratio, "the gain is from v, x to u", system=DOUBLE, gain=replace(LQR_GAIN, states=("v", "x"))),
    *(
        call(
            lqr.cost_ratio,
            "the gain K is ...: this model needs a finite one of (1, 2)",
            system=DOUBLE,
            gain=replace(LQR_GAIN, K=K),
        )
        for K in (np.ones((1, 1)), np.full((1, 2), np.nan))
    ),
    call(calibration.calibrate, "'scale' is none of gain", free=["scale"]),
    call(calibration.calibrate, "missing ['c']", readings={"b": 1.0, "c": 1.0}),
    *(
        call(gauss_newton.minimise, part, **changed)
        for changed, part in (
            ({"y": np.ones((2, 1))}, "the outputs have the shape (2, 1), the model's (3, 1)"),
            ({"start": [1.0]}, "start has the shape (1,) or is not finite: give 2 values"),
            ({"start": [1.0, np.nan]}, "or is not finite: give 2 values"),
            ({"parameters": ("a", "a")}, "'a' is listed twice"),
        )
    ),
    call(
        identify.fit_linear,
        "the equations hold 'q', which is neither",
        equations={"f": FORCE + ca.SX.sym("q")},
        **LINEAR,
    ),
    call(
        identify.fit_linear,
        "the log has no signal 'f'",
        equations={"f": FORCE},
        **LINEAR | {"log": Log({"x": [1.0], "v": [1.0], "a": [1.0]})},
    ),
    *(
        call(least_squares.solve, part, **{"y": [1.0, 2.0, 2.5], "parameters": ("k", "c"), "outputs": ("y",)} | changed)
        for changed, part in (
            ({"y": [1.0, np.nan, 2.0]}, "row 1 of 'y' is nan"),
            ({"Phi": [[1.0, 1.0], [2.0, np.inf], [3.0, 1.0]]}, "row 1 of the regressor of 'c' in 'y' is inf"),
            ({"y": [1.0, 2.0]}, "need (N, 1, 2)"),
            (
                {"Phi": [[1.0, 1.0], [2.0, 1.0]], "y": [1.0, 2.0]},
                "2 equations are too few for 2 parameters ...log 1 or",
            ),
            ({"level": 95.0}, "confidence level is 95"),
            ({"noise": {"y": 0.0}}, "the noise of 'y' is 0"),
            ({"noise": {"z": 1.0}}, "a noise is given for 'z', which is not one of the outputs y"),
            ({"noise": {}}, "the noise of 'y' is None"),
            ({"parameters": ()}, "no parameters are named"),
            ({"parameters": ("k", "k")}, "'k' is listed twice among the parameters"),
            ({"Phi": np.zeros((0, 2)), "y": []}, "0 equations are too few"),
            ({"y": [1e-200, 2e-200, 2.5e-200]}, "the output 'y' has the size 2.5e-200: choose units"),
            ({"Phi": np.array([[1.0, 1e200], [2.0, 1.0], [3.0, 1.0]])}, "1e+200"),
        )
    ),
    call(logs.parse, "line 1: there are no columns: begin with names and units", text="# nothing\n", required={}),
    *(
        call(
            logs.parse,
            f"'X' is asked for in '{unit}': logs are in SI units, give",
            text="X [m]\n1\n",
            required={"X": unit},
        )
        for unit in ("mm", "inch", "")
    ),
    *(
        call(Log, part, samples=samples, times=None)
        for samples, part in (
            ({"a": [1.0, np.nan]}, "row 1 of 'a' is nan: leave the row out"),
            ({"a": [1.0, 2.0], "b": [1.0]}, "1 samples of 'b' and 2 of 'a'"),
            ({"a": [[1.0]]}, "shape (1, 1)"),
            ({"a": ["x"]}, "'a' are no real numbers"),
            ({"a": []}, "no sample of 'a'"),
            ([[1.0]], "the log is a list: give samples by name"),
            ({}, "contains no signal"),
        )
    ),
    call(Log, "2 times and 3 rows", samples={"a": np.zeros(3)}, times=[0.0, 0.01]),
    *(
        call(identify.fit_trajectory, part, **STAGE_FIT | changed)
        for changed, part in (
            ({"parameters": ()}, "no parameters are named"),
            ({"parameters": ("k", "k")}, "'k' is listed twice among the parameters"),
            ({"measured": ("s", "s")}, "'s' is listed twice among the measured signals"),
            ({"measured": ("y",)}, "'y' is not an output or state of plant"),
            ({"measured": ()}, "no measured signals are named"),
            ({"free": ("x", "x")}, "'x' is listed twice among the free states"),
            ({"free": ("w",)}, "'w' is not a state"),
            ({"initial": {"s": 1.0}}, "'s' is not a state"),
            ({"initial": {"x": np.nan}}, "the initial value of 'x' is nan"),
            ({"span": 0}, "the span is 0 samples"),
            ({"span": 10**6}, "samples: give 1 or more, and fewer than the log's"),
            ({"span": 3, "free": ("x",)}, "initial states of spans are all estimated"),
            ({"span": 1, "measured": ("s", "x")}, "rows of 's', on which ...do not determine its noise"),
            ({"substeps": 0}, "0 Runge-Kutta steps"),
            ({"log": Log({n: v for n, v in FREE.samples.items() if n != "f"}, FREE.period_s)}, "no signal 'f'"),
        )
    ),
]
TIMING = [
    call(lead_lag.prewarped, "not between 0 and Nyquist, 314.159 rad/s", frequency=320.0),
    call(lead_lag.tustin, "give the continuous one", compensator=Compensator(1.0, (), (0.5,), D)),
    call(lead_lag.tustin, "must be finite and positive", period_s=-1.0),
    *(call(lqr.lqrd, "the delay is", delay_s=delay) for delay in (-0.1, np.inf, 1e9)),
    call(lqr.lqrd, "continuous", system=SAMPLED),
    call(lqr.lqrd, "the sample period is", period_s=0.0),
    call(lqr.cost_ratio, "the sample period is", period_s=0.0),
    call(Log, "period is 0", samples={"a": np.zeros(3)}, period_s=0.0, times=None),
    call(identify.fit_trajectory, "no sample period", **STAGE_FIT | {"log": Log(FREE.samples)}),
]

test_a_call_of_the_synthesis_raises_a_model_error = refusals(ModelError, MODEL)
test_a_call_of_the_synthesis_raises_a_signal_error = refusals(SignalError, SIGNAL)
test_a_call_of_the_synthesis_raises_a_timing_error = refusals(TimingError, TIMING)
