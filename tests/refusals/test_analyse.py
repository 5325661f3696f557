"""Refusals of synth.analyse: what a plant, a model or a loop must have."""

import casadi as ca
import control
import numpy as np

from models import maglev_stage
from synth import plant as plants
from synth.analyse import discretise, operating_points, time_response
from synth.analyse.loops import (
    disk,
    equilibrium,
    feedback_loop,
    interconnect,
    loop,
    peak_bounds,
    robustness,
    stability_margins,
    transfer,
)
from synth.analyse.numerics import magnitude
from synth.analyse.observability import information
from synth.analyse.structure import gramian, parity, relative_degree, structure, zero_dynamics
from synth.errors import ModelError, SignalError, TimingError
from synth.plant import Plant, Symbols
from synth.signals import Parameter, Signal
from synth.statespace import StateSpace, of
from synth.timing import Continuous, Discrete
from tests import textbook_plants
from tests.hostile import examples, search
from tests.refusals.table import call, refusals

C, D = Continuous(), Discrete(0.1)
LAG, MASS = of(([[-1.0]], [[1.0]], [[1.0]])), of(([[0.0, 1.0], [0.0, 0.0]], [[0.0], [0.5]], [[1.0, 0.0]]))
HELD = discretise.zero_order_hold(MASS, 0.1)
TWO = of((-np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2))))
FAST = ([[1000.0]], [[1.0]])
RESPONSES = (time_response.step_response, time_response.impulse_response)
S, Z = control.tf("s"), control.tf([1.0, 0.0], [1.0], 0.1)
X, Y, OTHER = ca.SX.sym("X"), ca.SX.sym("Y"), ca.SX.sym("T")
BOX = {"symbols": {"X": X, "Y": Y, "T": OTHER}, "box": (Signal("X", "m", -1.0, 2.0), Signal("Y", "rad", 0.0, 1.0))}
DIRECT = ("i_d1", "i_d2", "i_d3", "i_d4")
NORM = ca.Function("ranges", [ca.vertcat(X, Y)], [ca.norm_2(ca.vertcat(X, Y))])
AIRCRAFT, MAGLEV, BEAM = textbook_plants.aircraft(0.1), maglev_stage.plant(), textbook_plants.ball_and_beam(-1.0)
FLIGHT, DEGREE = operating_points.trim(AIRCRAFT, {}, ["T"]), relative_degree.of_plant(AIRCRAFT)
MOVING = operating_points.OperatingPoint(FLIGHT.x, [1.2, 0.0], FLIGHT.p, 0.2, FLIGHT.states, FLIGHT.inputs)
LOOPS = search.example("robustness.open_loops", robustness.open_loops)["loops"]


def tank(low: float = 0.0) -> Plant:
    """A tank with inflow q and gravity outflow: h' = q - a sqrt(h), whose slope is infinite at h = 0."""
    h, q, a = Signal("h", "m", low, 2.0), Signal("q", "m/s", -1.0, 1.0), Parameter("a", 0.5, "1", 0.0, "test")
    return plants.build("tank", (h,), (q,), (), (a,), lambda x, u, p: ({"h": u["q"] - p["a"] * ca.sqrt(x["h"])}, {}))


def on_a_spring() -> Plant:
    """A force F on a carriage with a spring of 4 N/m, 0.2 m off its centre, turns it on one of 8 N m/rad."""

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"q": x["v"], "v": u["F"] - 4 * x["q"], "theta": x["w"], "w": 0.2 * u["F"] - 8 * x["theta"]}, {}

    states = [Signal(name, unit, -1, 1) for name, unit in (("q", "m"), ("v", "m/s"), ("theta", "rad"), ("w", "rad/s"))]
    return plants.build("carriage", states, [Signal("F", "N", -10, 10)], (), (), physics)


def clock(y: bool = True) -> Plant:
    """A clock beside an integrator; its output is the square of the time, or of the input."""
    states, u = [Signal("t", "s", 0, 1), Signal("x", "m", -1, 1)], Signal("u", "m/s", -1, 1)

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"t": ca.SX(1), "x": u["u"]}, {"y": x["t"] ** 2 + (x["x"] - x["x"]) if y else u["u"] ** 2}

    return plants.build("clock", states, [u], [Signal("y", "s", 0, 1)], [], physics)


def driven(unit: str = "m") -> Plant:
    """An integrator with a sensor of its state, one that its input reaches, and one that shows nothing."""
    q, f = Signal("q", "m", -1.0, 1.0), Signal("f", "N", -1.0, 1.0)
    outputs = [Signal("a", "m", -2.0, 2.0), Signal("b", "m", -2.0, 2.0), Signal("c", unit, -2.0, 2.0)]

    def physics(x: Symbols, u: Symbols, p: Symbols) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        return {"q": u["f"]}, {"a": x["q"], "b": x["q"] + 0.5 * u["f"], "c": x["q"] if unit == "rad" else ca.SX(1)}

    return plants.build("driven", [q], [f], outputs, [], physics)


def sensors(names: str) -> dict[str, object]:
    return {"sensors": {n: n for n in names}, "tolerances": dict.fromkeys(names, parity.Tolerance(1e-5, 7e-6))}


def of_level(rate: object) -> dict[str, Plant]:
    level, flow = ca.SX.sym("level"), ca.SX.sym("flow")
    return {"plant": textbook_plants.with_input(ca.Function("rate", [level, flow], [rate(level, flow)]))}  # type: ignore[operator]


def deviation(size: float, change: float) -> dict[str, object]:
    return {"deviations": lambda q: np.full_like(q, size), "changes": lambda q, half: np.full_like(q, change)}


def coordinates(**weights: dict[str, float]) -> dict[str, object]:
    rows = search.example("robustness.of_controller", robustness.of_controller)
    return {"loops": robustness.of_controller(**rows, coordinates=weights), "signals": list(weights)}


MODEL = [
    call(disk.of_loop, "poles at 0.5...stabilise", loop=control.ss(control.tf([0.5], [1, -1]))),
    call(disk.of_loop, "poles at 2+3i, ", loop=([[2, 3], [-3, 2]], np.eye(2), 0 * np.eye(2), 0 * np.eye(2))),
    call(disk.of_loop, "I + D is singular", loop=([[-1.0]], [[1.0]], [[1.0]], [[-1.0]])),
    call(disk.loop_at_a_time, "poles at -1", loop=([[-1.0]], [[0.0]], [[0.0]], [[0.0]], D)),
    call(
        feedback_loop.close,
        "I + P K has no inverse: ...put a delay or a lag",
        plant=([[-1.0]], [[1.0]], [[1.0]], [[0.5]]),
        controller=([[-1.0]], [[1.0]], [[1.0]], [[-2.0]]),
    ),
    call(
        interconnect.connect,
        "I - W D is singular",
        models=[([[-1.0]], [[1.0]], [[1.0]], [[1.0]])],
        inputs=[],
        outputs=["y1"],
        wires={"u1": {"y1": 1.0}},
    ),
    *(
        call(peak_bounds.state_bounds, "no bound: a mode", system=([[a]], [[1.0]], [[1.0]], [[0.0]], D))
        for a in (1.0, 1 - 1e-08, 1.01)
    ),
    call(magnitude.conditioning, "no determinant", matrix=ca.horzcat(X, Y), **BOX),
    call(magnitude.magnitudes, "term 'pole' is not finite at", terms={"pole": 1 / Y}, **BOX, along="T", points=[0.0]),
    *(
        call(
            information.search,
            "unknown 0 exceeds ...at q = ...rank seems to be lost: add a sensor",
            deviations=lambda q, p=pole: np.divide(1, np.abs(q - p), np.full_like(q, np.inf), where=q != p),
            changes=lambda q, half: half + 0 * q,
            low=[0.0],
            high=[2.0],
            cells=[3],
            tolerance=0.001,
            max_cells=2000,
        )
        for pole in (1.001, 1.0)  # between the middles of cells, and on one
    ),
    call(information.search, "the lower ones first", low=[1.0], high=[0.0]),
    call(information.search, "are more than 3000", cells=[10**9], tolerance=0.001, max_cells=30000000),
    *(call(information.search, f"the tolerance is {t}", tolerance=t) for t in (np.nan, 0.0)),
    *(call(information.search, "both are bounds of sizes", **deviation(*d)) for d in ((1.0, -5.0), (-1.0, 0.1))),
    call(information.jacobians, "no finite derivative at [0. 0.]: leave", h=NORM, q=[[1.0, 1.0], [0.0, 0.0]]),
    call(
        gramian.over_horizon,
        "over 1 s is not determined ...; take a shorter horizon",
        system=([[0.0, 1.0], [400.0, 0.0]], [[1.0], [-20.0]], [[20.0, -1.0]], [[0.0]]),
        horizon_s=1.0,
    ),
    *(
        call(
            relative_degree.affine,
            "'tank' is not affine ...rate of 'level' in flow. Make flow states, with",
            **of_level(rate),
        )
        for rate in (
            lambda level, flow: flow**2,
            lambda level, flow: flow * level * flow,
            lambda level, flow: ca.fabs(flow),
            lambda level, flow: ca.sign(flow),
            lambda level, flow: ca.fmin(flow, 0.5),
            lambda level, flow: level * flow + 1e-09 * flow**3,
            lambda level, flow: ca.exp(flow) / level,
        )
    ),
    call(relative_degree.affine, "not affine in its inputs: 'y' in u", plant=clock(False)),
    call(
        relative_degree.affine,
        "the rate of 'vy' in i_d1; the rate of 'wphi' in i_d1. ",
        plant=MAGLEV,
        held=dict.fromkeys(("i_d2", "i_d3", "i_d4", "u_x", "u_z"), 0.0),
    ),
    call(parity.relations, "mixes", plant=driven("rad"), **sensors("ac")),
    call(parity.relations, "give an output", sensors={"a": "nothing"}),
    call(parity.relations, "'b' depends on the input 'f', ...: leave its sensor", plant=driven(), **sensors("ab")),
    call(parity.relations, "the output 'c' depends on no state: leave its", plant=driven(), **sensors("ac")),
    call(parity.relations, "no sensors are given", plant=driven(), **sensors("")),
    call(relative_degree.of_plant, "'y' in plant 'clock' is not defined: none of its 2 ", plant=clock()),
    call(
        relative_degree.of_plant,
        "not finite at x1 = 0",
        plant=textbook_plants.hidden(ca.Function("e", [X, Y], [ca.sqrt(X - 0.5)])),
    ),
    call(
        relative_degree.of_plant(AIRCRAFT, held={"M": 0.0}).require_constant_rank,
        "2 outputs (px, pz) meet 1 inputs (T): choose as many outputs",
    ),
    call(
        structure.require_stabilisable,
        "not stabilisable: mode 1.5 in tilt has ...inputs force: actuate tilt or",
        A=[[0, 1, 0], [0, 0, 0], [0, 0, 1.5]],
        B=[[0], [1], [0]],
        states=("gap", "speed", "tilt"),
        inputs=("force",),
    ),
    call(
        structure.require_detectable,
        "(Q, A) is not detectable: mode 0 in gap has |C v| = 0e+00: weight or",
        A=[[0, 1], [0, 0]],
        C=np.diag([0.0, 1.0]),
        states=("gap", "speed"),
        what="Q",
    ),
    call(
        zero_dynamics.at_point,
        "degree of (y) is not defined at the point: ...condition inf ...another point",
        plant=BEAM,
        degree=relative_degree.of_plant(BEAM),
        point=operating_points.trim(BEAM, {}, []),
    ),
    call(
        zero_dynamics.at_point,
        "found for other parameters",
        plant=AIRCRAFT.with_parameters(eps=0.2),
        degree=DEGREE,
        point=FLIGHT,
    ),
    call(
        zero_dynamics.at_point,
        "not at rest at the point: 'vz' changes by 0.2 per s: trim",
        plant=AIRCRAFT,
        degree=DEGREE,
        point=MOVING,
    ),
    call(
        zero_dynamics.at_point,
        "'T' is held at 1.1, but 1 at the point",
        plant=AIRCRAFT,
        degree=relative_degree.of_plant(AIRCRAFT, ["px"], {"T": 1.1}),
        point=FLIGHT,
    ),
    call(
        discretise.tustin,
        "a pole at 1/h, ...maps to infinity",
        system=([[256.0]], [[1.0]]),
        period_s=1 / 128,
        frequency=0.0,
    ),
    call(
        discretise.inverse_tustin,
        "a pole at z = -1, ...maps to infinity",
        system=([[-1.0]], [[1.0]], [[1.0]], [[0.0]], 0.1),
    ),
    *(
        call(
            discretise.inverse_zero_order_hold,
            f"a pole at z = {z}, which no",
            system=([[z]], [[1.0]], [[1.0]], [[0.0]], 0.1),
        )
        for z in (0, -0.5)
    ),
    *(
        call(function, "over 1 s exceeds what a double holds: take a shorter period", **changed, period_s=1.0)
        for function, changed in (
            (discretise.first_order_hold, {"A": FAST[0], "B": FAST[1]}),
            (discretise.gramian, {"F": FAST[0], "W": [[1.0]]}),
            (discretise.zero_order_hold, {"system": FAST}),
        )
    ),
    call(
        operating_points.trim,
        "no trim: d(h)/dt = 0 cannot be met; the least found is -0.3 m/s",
        plant=tank(),
        fixed={"q": -0.3},
        free=["h"],
    ),
    call(
        operating_points.trim,
        "d(h)/dt is not finite ...in the ranges of q",
        plant=tank(-2.0),
        fixed={"h": -1.0},
        free=["q"],
    ),
    *(
        call(operating_points.trim, part, plant=MAGLEV, fixed={"y": 0.025} | fixed, free=free)
        for fixed, free, part in (
            ({"vy": 0.1}, DIRECT, "d(y)/dt = 0 cannot be met; the least found is 0.1 m/s"),
            ({}, (), "d(vy)/dt = 0 ...nothing free"),
            ({}, ("u_x",), "/dt = 0 ...u_x free"),
            ({"u_z": 1.0}, DIRECT, "d(vz)/dt = 0 cannot be met"),
            ({"y": 0.0}, DIRECT, "not finite"),
        )
    ),
    call(
        operating_points.trim,
        "with F free and q held and v, theta, w at 0: free a signal that acts on",
        plant=on_a_spring(),
        fixed={"q": 0.5},
        free=["F"],
    ),
    call(
        operating_points.trim_with_free_states,
        "d(q)/dt = 0 cannot be met; ...with F, theta, w free and q, v held: free",
        plant=on_a_spring(),
        fixed={"q": 0.5, "v": 0.5},
        free=["F"],
    ),
    *(call(f, "beyond what a double holds", system=1 / (S - 1), duration_s=1000.0) for f in RESPONSES),
]
SIGNAL = [
    call(time_response.forced_response, "the model has no input 'u': it has f", inputs={"u": [1.0]}),
    call(time_response.forced_response, "the model has no state 'z': it has x, v", initial={"z": 1.0}),
    call(time_response.forced_response, "input 'f' has the shape (2, 2)", inputs={"f": np.eye(2)}),
    call(time_response.forced_response, "input 'f' has the shape (2,) or is not finite", inputs={"f": [1.0, np.nan]}),
    call(time_response.forced_response, "no inputs are given", inputs={}),
    call(disk.of_loop, "as many outputs as inputs", loop=([[-1.0]], [[1.0, 2.0]], [[1.0]])),
    call(disk.least, "below is 0.0: it must be above 0", loops=[], below=0.0),
    call(equilibrium.SampledLoop, "'height' is not one of gap", sensors={"seen": "height"}),
    call(equilibrium.SampledLoop, "'torque' is not one of drive", actuators={"current": "torque"}),
    call(equilibrium.open_loop, "neither a sensor nor an actuator: name one of seen, current", signal="wish"),
    call(equilibrium.solve, "not known ['hope']", references={"hope": 1.0}),
    call(feedback_loop.close, "give the controller an input for each output", plant=MASS, controller=TWO),
    call(
        feedback_loop.close,
        "drives u2, u1 but the plant takes u1, u2: bring one",
        plant=TWO,
        controller=TWO.renamed({"y1": "u2", "y2": "u1", "u1": "a", "u2": "b"}),
    ),
    call(
        feedback_loop.close,
        "'q' is in m, the controller's 'e' in rad: convert one",
        plant=StateSpace([[0.0]], [[1.0]], [[1.0]], [[0.0]], ("q",), ("f",), ("q",), C, {"q": "m"}),
        controller=StateSpace([[-8.0]], [[1.0]], [[2.0]], [[0.0]], ("l",), ("e",), ("f",), C, {"e": "rad"}),
    ),
    *(
        call(
            feedback_loop.close,
            f"the plant has {m} inputs and {p} outputs, ...at least one of each",
            plant=(-np.eye(n), np.zeros((n, m)), np.zeros((p, n)), np.zeros((p, m))),
            controller=(-np.eye(n), np.zeros((n, p)), np.zeros((m, n)), np.zeros((m, p))),
        )
        for n, p, m in ((0, 0, 0), (1, 1, 0), (1, 0, 1))
    ),
    call(feedback_loop.feedback, "has no unit feedback", forward=([[-1.0]], [[1.0, 2.0]], [[1.0]])),
    call(interconnect.connect, "'q' is not one of x, f", wires={"f": {"q": 1.0}}),
    *(call(interconnect.connect, "the factor is ", wires={"f": {"f": factor}}) for factor in (np.nan, np.inf)),
    call(interconnect.connect, "listed 2 times among the models' ", models=[LAG, LAG]),
    call(interconnect.connect, "'x' is an external input and a model's output", inputs=["x"]),
    call(interconnect.connect, "there are no models to connect", models=[]),
    call(interconnect.connect, "'force' reaches no model: ...in no wire: f", inputs=["force"], wires={}),
    call(interconnect.integrals, "'nope' is no signal of the model: give some of", signals={"z": "nope"}),
    call(loop.cut, "no Block drives 'gap': open the loop at a signal that one drives", signal="gap"),
    call(loop.linearise_block, "not known ['spin']", state={"spin": 1.0}),
    call(loop.linearise_block, "missing ['u']", inputs={}),
    call(loop.open_loop, "'height' is not one of", sensors={"x": "height"}),
    call(loop.open_loop, "'eye' is not one of", sensors={"eye": "x"}),
    call(loop.open_loop, "'torque' is not one of c, s_out", actuators={"f": "torque"}),
    call(loop.open_loop, "neither a sensor nor an actuator: name one of x, f", signal="rate"),
    call(
        loop.open_loop,
        "feedthrough to 'x': give the loop at least one sample",
        plant=StateSpace([[-1.0]], [[1.0]], [[1.0]], [[1.0]], ("x",), ("f",), ("x",), C),
        delay=0,
    ),
    *(call(peak_bounds.state_bounds, "give 1, one for", inputs=u) for u in ([1.0, 1.0], [-1.0], [np.inf])),
    call(robustness.corners, "parameter 'a' is 0.5 ...the tolerance 0", plant=tank(), parameters=["a"]),
    call(robustness.corners, "2^11 corners", parameters=["k"] * 11),
    call(robustness.equilibrium_at, "no operating point 'mid': choose one of middle", point="mid"),
    call(robustness.of_controller, "no operating points", points={}),
    call(robustness.checks, "'phase' is not a known margin", require={"phase": 1.0}),
    call(robustness.checks, "the required phase_margin is NaN", require={"phase_margin": np.nan}),
    call(robustness.checks, "no loop to check", loops=[], require={"phase_margin": 1.0}),
    call(robustness.open_loops, "a, b are linearly dependent", **coordinates(a={"gap": 1.0}, b={"gap": 2.0})),
    call(robustness.open_loops, "at 'gap' and at a coordinate of it at once", **coordinates(gap={"gap": 1.0})),
    call(robustness.open_loops, "the wire from 'w' to 'a': 'w' is not one of", **coordinates(a={"w": 1.0})),
    call(stability_margins.of_loop, "open it at one signal", loop=TWO),
    *(call(stability_margins.of_loop, "give 0 < low < high", low=low, high=1.0) for low in (10.0, 1.0)),
    *(call(stability_margins.of_loop, "give ", high=high) for high in (-1.0, 0.0)),
    *(
        call(stability_margins.of_loop, "give ", loop=L, low=low)
        for L in (1 / (S + 1), 1 / (Z - 0.5), transfer.with_delay_and_hold(1 / (S + 1), 0.1))
        for low in (-1.0, 0.0)
    ),
    call(transfer.with_delay_and_hold, "open it at one signal", system=TWO),
    call(transfer.response, "open it at one signal", loop=TWO),
    call(magnitude.conditioning, "contains T", matrix=OTHER, **BOX),
    call(magnitude.conditioning, "box is empty", matrix=X, symbols={}, box=()),
    call(magnitude.magnitudes, "no symbol for Z", terms={"e": X}, **BOX, along="Z"),
    call(relative_degree.affine, "no output 'pq': it has px, pz", plant=AIRCRAFT, outputs=["pq"]),
    call(relative_degree.affine, "each once", plant=AIRCRAFT, outputs=["px", "px"]),
    call(relative_degree.affine, "name at least one", plant=AIRCRAFT, outputs=[]),
    call(relative_degree.affine, "no input 'Q' to hold: it has T, M", plant=AIRCRAFT, held={"Q": 1.0}),
    call(relative_degree.affine, "'T' is held at nan", plant=AIRCRAFT, held={"T": np.nan}),
    call(relative_degree.affine, "every input is held", plant=AIRCRAFT, held={"T": 1.0, "M": 0.0}),
    *(
        call(
            zero_dynamics.of_linear,
            f"has {n} states and {m} inputs: give one with at least one of each",
            system=(np.zeros((n, n)), np.ones((n, m)), np.ones((m, n)), np.eye(m)),
            degrees=[0] * m,
        )
        for n, m in ((0, 1), (2, 0))
    ),
    call(
        zero_dynamics.of_linear,
        "1 degrees, 2 outputs and 2 inputs",
        system=operating_points.linearise(AIRCRAFT, FLIGHT),
        degrees=(2,),
    ),
    call(discretise.gramian, "W is not symmetric: [0, 1] is 1.0, [1, 0] is 0.0", W=[[1, 1], [0, 1]]),
    call(discretise.gramian, "F is (2, 2) and W is (3, 3)", W=np.eye(3)),
    call(
        operating_points.linearise, "not those of plant 'maglev_stage'", plant=MAGLEV, point=examples.usual()["point"]
    ),
    call(operating_points.trim, "both", plant=MAGLEV, fixed={"y": 0.025}, free=("y",)),
    call(operating_points.trim, "twice", plant=MAGLEV, fixed={"y": 0.025}, free=("i_d1", "i_d1")),
]
TIMING = [
    call(interconnect.connect, "continuous time meets discrete time", models=[LAG, HELD]),
    call(loop.sampled, "discrete time of 0.1 s cannot be sampled", plant=HELD),
    call(loop.open_loop, "continuous", controller=LAG),
    call(peak_bounds.state_bounds, "continuous", system=LAG),
    call(transfer.with_delay_and_hold, "discrete time of 0.1 s cannot be delayed ...its plant", system=HELD),
    call(transfer.with_delay_and_hold, "it must be finite and 0 or more", delay_s=-0.1),
    call(transfer.with_delay_and_hold, "it must be finite and 0 or more", hold_s=-1.0),
    call(gramian.over_horizon, "the horizon is ...: give a finite positive time", horizon_s=0.0),
    call(gramian.over_horizon, "shorter than a sample", system=HELD, horizon_s=0.02),
    call(zero_dynamics.of_linear, "0.1 s: give the continuous one", system=HELD, degrees=[1]),
    call(discretise.zero_order_hold, "discrete time of 0.1 s cannot be sampled", system=HELD),
    *(call(discretise.first_order_hold, "finite and positive", period_s=T) for T in (0.0, -1.0)),
    call(discretise.tustin, "discrete time of 0.1 s cannot be sampled", system=HELD),
    call(discretise.tustin, "from 0 to below Nyquist, 314.159 rad/s", frequency=314.2),
    call(discretise.inverse_tustin, "from 0 to below Nyquist, 31.4159 rad/s", system=HELD, frequency=-1.0),
    *(
        call(f, "no sample period", system=MASS)
        for f in (discretise.inverse_zero_order_hold, discretise.inverse_tustin)
    ),
    call(time_response.forced_response, "with the interval None: give it to a continuous", interval_s=None),
    call(
        time_response.forced_response,
        "with the interval 0.01: give it to a continuous",
        system=HELD,
        inputs={"u1": [0.0, 1.0]},
        initial={},
    ),
    call(discretise.delay_samples, "sample the model", system=MASS),
    call(discretise.delay_samples, "delay of -1 samples", samples=-1),
    *(
        call(function, part, system=system, duration_s=duration, interval_s=interval)
        for function in RESPONSES
        for system, duration, interval, part in (
            (1 / (S + 1), -1.0, None, "the duration is -1.0: give a finite positive number"),
            (1 / (S + 1), 1.0, 1e-09, "hold 1000000000 intervals"),
            (1 / (S + 1), 1.0, 2.0, "hold 0 intervals of 2 s"),
            (1 / (Z - 0.5), 1.0, 0.1, "has its own interval, but 0.1 s was given"),
        )
    ),
]

test_a_call_of_the_analysis_raises_a_model_error = refusals(ModelError, MODEL)
test_a_call_of_the_analysis_raises_a_signal_error = refusals(SignalError, SIGNAL)
test_a_call_of_the_analysis_raises_a_timing_error = refusals(TimingError, TIMING)
