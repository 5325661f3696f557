"""Refusals of synth.synthesise: what an estimator, a regulator or a Riccati equation must have."""

from dataclasses import replace

import casadi as ca
import numpy as np
import scipy.linalg

from synth.analyse import discretise
from synth.errors import ModelError, SignalError, TimingError
from synth.statespace import StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman, lqg, reduced_observer, square_root_kalman
from synth.synthesise.regulation import anti_windup, internal_model, regulator_equations, servo, steady_error
from synth.synthesise.regulation.regulator_equations import Mode
from synth.synthesise.riccati import riccati, weights
from synth.timing import Continuous, Discrete
from tests.hostile import examples
from tests.refusals.table import call, refusals
from tests.synthesise.mass_spring import DAMP, MASS, SPRING
from tests.synthesise.observers.models import by_poles, held_mass, mass, scalar

C, D, T = Continuous(), Discrete(0.1), 1e-3
USUAL = examples.usual()
DOUBLE = StateSpace([[0, 1], [0, 0]], [[0], [1]], np.eye(2), np.zeros((2, 1)), ("x", "v"), ("u",), ("x", "v"), C)
SAMPLED = discretise.zero_order_hold(DOUBLE, 0.1)
BIASED = StateSpace(np.diag([-1.0, 0.0]), [[1], [0]], [[1, 0]], [[0]], ("x", "bias"), ("u",), ("y",), C)
LAGS = ([[0, 1, 0], [0, 0, 1], [-1, -3, -3]], [[0], [0], [1]])  # 1 / (s + 1)^3
V = ca.SX.sym("v", 2)
Q = ca.SX.sym("q", 2)
SPRUNG = {p.name: ca.SX.sym(p.name) for p in (MASS, DAMP, SPRING)}
FILTER = USUAL["estimator"]
OBSERVED = discretise.zero_order_hold((np.kron([[0, 1], [0, 0]], np.eye(2)), np.eye(4)[:, 2:], np.eye(4)[:2]), 0.1)
OBSERVED = replace(OBSERVED, states=("p", "q", "dp", "dq"), inputs=("f", "g"), outputs=("p", "q"))
SHOWN = replace(OBSERVED, C=[*OBSERVED.C, 1e-6 * OBSERVED.C[0], 0 * OBSERVED.C[0]], D=np.zeros((4, 2)),
                outputs=("p", "q", "r", "s"))  # fmt: skip
PAIR = by_poles(OBSERVED, ("p", "q"), [0.5, 0.5])
PAIR_GAIN = lqr.lqr(OBSERVED, np.eye(4), np.eye(2)).K
SEEN = StateSpace(
    [[1, T], [0, 1]], [[0], [T]], [[1, 0], [0, 0]], [[0], [1]], ("x", "v"), ("f",), ("gap", "a"), Discrete(T)
)
START = square_root_kalman.initial(SEEN, [1, 1])
REGULATED = replace(DOUBLE, C=[[1, 0]], D=[[0]], outputs=("x",))
SINES = (REGULATED, [0.0, 10.0], np.eye(5), [1.0])


def third(C: object, time: object = C) -> StateSpace:
    C = np.atleast_2d(np.asarray(C, float))
    return StateSpace(
        *LAGS, C, np.zeros((len(C), 1)), ("a", "b", "c"), ("f",), tuple(f"y{i}" for i in range(len(C))), time
    )


def coupled(scale: float = 1.0) -> StateSpace:
    """y1 = g (u1 + u2), y2 = g (u1 + u2) + (s^2 + 4) / (s + 1)^2 u2, g = 1 / (s + 1): y2 - y1 has a zero at 2 rad/s."""
    A, B = scipy.linalg.block_diag([[-1.0]], [[0.0, 1.0], [-1.0, -2.0]]), [[1.0, 1.0], [0.0, 0.0], [0.0, 1.0]]
    C_, D_ = [[1.0, 0.0, 0.0], [scale, 3.0 * scale, -2.0 * scale]], [[0.0, 0.0], [0.0, scale]]
    return StateSpace(A, B, C_, D_, ("a", "b", "c"), ("u1", "u2"), ("y1", "y2"), C)


MODEL = [
    call(reduced_observer.compensator, "leaves the poles ...with the sign inside K", observer=PAIR, K=-PAIR_GAIN),
    call(reduced_observer.from_gain, "p, r depend on each other", system=SHOWN, measured=("p", "q", "r")),
    call(reduced_observer.from_gain, "s shows no state: its row of C is 0", system=SHOWN, measured=("p", "s")),
    call(reduced_observer.from_gain, "nothing is left to estimate", system=SHOWN, measured=("p", "q", "dp", "dq")),
    *(
        call(reduced_observer.from_gain, part, system=replace(SAMPLED, units={}), measured=["x"], L=[[gain]])
        for gain, part in (
            (0.0, "observer of v with this gain has the poles 1: ...which needs |z| < 1"),
            (20.0, "has the poles -1: its error does not decay"),
            (20.1, "has the poles -1.01: its error does not decay"),
        )
    ),
    *(
        call(
            reduced_observer.from_gain,
            "the model has no states",
            measured="y",
            L=[[1.0]],
            system=StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[0.0]], (), ("u",), ("y",), time),
        )
        for time in (C, D)
    ),
    *(
        call(function, part, system=system, W=W, V=V)
        for function, system, W, V, part in (
            (kalman.continuous, BIASED, [1, 1], [1], "not detectable: mode 0 in bias"),
            (kalman.continuous, replace(BIASED, C=[[1, 1]]), {"x": 1}, [1], "no noise excites the mode 0 in bias"),
            (kalman.discrete, scalar(1, Discrete(1)), [0], [1], "no noise excites the mode 1 in x1"),
            (kalman.continuous, mass(), {"v": 1}, [0.0], "measurement of y ...reduced-order observer"),
            (kalman.continuous, DOUBLE, [1, 1], [[1, 1], [1, 1]], "measurement of x, v ...reduced-order"),
            (kalman.kalmd, mass(), {"v": 1}, [0.0], "measurement of y has no white noise"),
        )
    ),
    *(
        call(
            lqg.from_measurement,
            "p, q are linearly dependent in the states that may change",
            estimator=kalman.kalmd(plant, np.eye(4), np.eye(2), 0.1).current(),
            plant=discretise.zero_order_hold(plant, 0.1),
            deviations={"q": 0.0},
        )
        for plant in [
            StateSpace(
                np.kron([[0, 1], [0, 0]], np.eye(2)),
                [[0], [0], [1], [1]],
                [[1, 1, 0, 0], [1, -1, 0, 0]],
                np.zeros((2, 1)),
                ("p", "q", "dp", "dq"),
                ("f",),
                ("p", "q"),
                C,
            )
        ]
    ),
    *(
        call(
            anti_windup.back_calculation,
            f"winds up: ...{part} decay_per_s",
            regulator=servo.lqr(*SINES),
            decay_per_s=r,
        )
        for r, part in ((1e-14, "choose a larger"), (1e8, "decides its decay at 1e+08 1/s: choose a smaller"))
    ),
    call(
        anti_windup.back_calculation,
        "is 10000, and the gain ...deadbeat already: give ...of 40000 1/s or less",
        regulator=servo.lqrd(*SINES, 1e-3),
        decay_per_s=1e7,
    ),
    call(internal_model.augmented, "zero at 0 rad/s", plant=third([0, 1, 0]), exosystem=(0.0, 2.0)),
    call(
        internal_model.augmented, "2 outputs (y0, y1) cannot be regulated by 1 inputs (f)", plant=third(np.eye(3)[:2])
    ),
    call(
        servo.lqr,
        "from f to y0 has a transmission zero at 2 rad/s",
        system=third([4, 0, 1]),
        exosystem=[2.0],
        Q=np.eye(5),
    ),
    call(servo.lqr, "2 outputs (x, v) cannot be regulated by 1 inputs", system=DOUBLE, Q=np.eye(4)),
    call(
        regulator_equations.require_solvable,
        "2 outputs (y1, y2) cannot be regulated by 1 inputs (u1)",
        model=coupled().select(("y1", "y2"), ("u1",)),
    ),
    call(
        regulator_equations.require_solvable,
        "not stabilisable: mode 1 in b",
        model=StateSpace(np.diag([-1.0, 1.0]), [[1], [0]], [[1, 1]], [[0]], ("a", "b"), ("u",), ("y",), C),
    ),
    call(
        steady_error.evaluate,
        "pole at the mode -0.5 1/s of the exosystem: make it stable",
        system=StateSpace([[-0.5]], [[1]], [[1]], [[0]], ("x",), ("r",), ("e",), C),
        errors=["e"],
        exosystem=replace(internal_model.of((0.0,)), modes=(Mode(-0.5 + 0j, 1),)),
    ),
    call(
        riccati.solve, "not stabilisable: mode 1 in x1 ...inputs u1: actuate x1", system=(np.diag([1, -1]), [[0], [1]])
    ),
    *(
        call(
            riccati.solve,
            "does not show the mode ...in x1...stability boundary...weight x1",
            Q=np.diag([0.0, 1.0]),
            system=(np.diag([mode, 0.3 - abs(mode)]), np.ones((2, 1)), time),
        )
        for mode, time in ((0.0, C), (1.0, D), (-1.0, D))
    ),
    *(
        call(riccati.solve, "not stabilisable: mode ...in x1", system=(np.diag([a, 0.3 - a]), [[0], [1]], time))
        for a, time in ((0.0, C), (1.0, D))
    ),
    *(
        call(
            riccati.solve,
            "the cost is indefinite...has no lower bound...raise Q",
            system=([[0.5]], [[1.0]], t),
            Q=[[-1.0]],
        )
        for t in (C, D)
    ),
]
SIGNAL = [
    *(
        call(lqg.from_measurement, part, **changed)
        for changed, part in (
            ({"measured": ["there"]}, "'there' is not an output of the plant that the estimator takes: x"),
            ({"estimator": FILTER.current().renamed({"x": "a"})}, "none of which is an output of the plant"),
            ({"values": {"height": 1.0}}, "the start has the values"),
            ({"deviations": {"v": -1.0}}, "deviation of 'v' at the start is below 0"),
        )
    ),
    call(
        lqg.current,
        "'x' is not both",
        gain=lqr.lqr(mass().renamed({"x": "z"}), np.eye(2), [1.0]),
        estimator=kalman.continuous(mass(), [1e-3], [25e-13], G=mass().B),
    ),
    call(
        lqg.predictor,
        "input 'f' is not both ...has no inputs: if the G ...column of B instead, `G=B[:, [0]]`, and it stays",
        gain=lqr.lqrd(mass(), np.eye(2), [1.0], T),
        estimator=kalman.kalmd(mass(), [1.0], [1.0], T, ["f"]),
    ),
    call(
        reduced_observer.compensator,
        "the gain K is (2, 3): ...need a finite one of (2, 4)",
        observer=PAIR,
        K=PAIR_GAIN[:, :3],
    ),
    call(reduced_observer.compensator, "need a finite one", observer=PAIR, K=PAIR_GAIN * np.nan),
    call(
        reduced_observer.compensator,
        "'f_late1', an input of the computed states, is not known",
        observer=PAIR,
        K=PAIR_GAIN,
        computed=StateSpace([[1]], [[1]], [[1]], [[0]], ("z",), ("f_late1",), ("z",), D),
    ),
    call(reduced_observer.from_gain, "measured signals are none: name one or more", system=SHOWN, measured=()),
    call(reduced_observer.from_gain, "p, p: name one or more, each once", system=SHOWN, measured=("p", "p")),
    call(reduced_observer.from_gain, "'z' is neither output nor state: take one of", system=SHOWN, measured=("z",)),
    call(
        reduced_observer.from_gain,
        "the gain L is (1, 2): v from x need (1, 1)",
        system=SAMPLED,
        measured="x",
        L=[[1.0, 2.0]],
    ),
    call(reduced_observer.from_gain, "the gain L has inf for v from x", system=SAMPLED, measured="x", L=[[np.inf]]),
    *(
        call(function, part, system=system, W=W, V=V, **more)
        for function, system, W, V, more, part in (
            (kalman.continuous, mass(), {"v": 1}, [-1.0], {}, "V has the eigenvalue -1"),
            (kalman.continuous, mass(), [[1, 2], [0, 1]], [1], {}, "W is not symmetric"),
            (kalman.continuous, mass(), [1, np.nan], [1], {}, "W has nan"),
            (kalman.continuous, mass(), {"q": 1}, [1], {}, "names 'q'"),
            (kalman.continuous, mass(), [1, 1], [1], {"S": [[0], [2]]}, "S is larger than W and V allow"),
            (kalman.continuous, mass(), [1, 1], [1], {"S": [[0, 2]]}, "S is "),
            (kalman.continuous, mass(), [1], [1], {"G": "g"}, "'g' is not one of f"),
            (kalman.continuous, mass(), [1], [1], {"G": [[1.0]]}, "G is ...2 states"),
            (kalman.continuous, mass().select((), ("f",)), [1, 1], [], {}, "0 outputs"),
            (kalman.kalmd, (-1, 1, 1, 1), [1], [1], {"G": "u1"}, "has a direct path to y1"),
            *((kalman.continuous, REGULATED, [v, v], [v], {}, "choose") for v in (1e-310, 1e-120, 1e120)),
            *((kalman.discrete, SAMPLED, [1.0, 1.0], [v, v], {}, "choose") for v in (1e-310, 1e-120, 1e120)),
        )
    ),
    call(square_root_kalman.initial, "P has the eigenvalue -1", P=[1, -1]),
    call(square_root_kalman.initial, "x is given for x: 'v'", x={"x": 1}),
    *(
        call(square_root_kalman.update, part, **{"estimate": START, "system": SEEN, "V": [1, 1]} | changed)
        for changed, part in (
            ({"y": {"gap": np.nan}}, "leave out a sample"),
            ({"y": {"tilt": 1}}, "'tilt' is not one"),
            ({"y": [1, 2, 3], "u": [0]}, "y is "),
            ({"y": {"a": 2.0}, "u": None}, "a depend directly on f: give u"),
        )
    ),
    call(square_root_kalman.predict, "W has the eigenvalue", W=[[1, 2], [2, 1]]),
    call(square_root_kalman.predict, "the model of x1", system=(0.5, 1.0, 1.0, 0.0, D), W=[1.0]),
    *(call(anti_windup.back_calculation, "/s: give a finite rate above 0", decay_per_s=r) for r in (0.0, -1.0, np.inf)),
    *(
        call(internal_model.exosystem, "distinct finite numbers >= 0", frequencies=f)
        for f in ((), (-1.0,), (1.0, 1.0), (0.0, 0.0), (np.inf,))
    ),
    *(
        call(internal_model.exosystem, "a whole number", frequencies={0.0: 1, 2.0: count})
        for count in (0, -1, 1.5, 1e9)
    ),
    call(internal_model.leapfrog, "frequency 3200.0 rad/s: it must lie below 314.159 rad/s", frequencies=(0.0, 3200.0)),
    call(internal_model.leapfrog, "has 2 entries, the internal model 3 states: give 3", E=[1.0, 2.0]),
    call(
        internal_model.in_time, "frequency 3200.0 rad/s: it must lie below 31.4159 rad/s", exosystem=(3200.0,), time=D
    ),
    call(
        servo.controller,
        "a mode that grows or counts more than once",
        regulator=servo.lqrd(REGULATED, {0.0: 2}, np.ones(4), [1.0], T),
    ),
    *(call(regulator_equations.roots, "give a", S=S) for S in (np.zeros((2, 3)), np.zeros((0, 0)), [[np.nan]])),
    call(servo.lqrd, "names 'xi2_x', which is not one of x, v, xi1", Q={"xi2_x": 1.0}),
    *(
        call(riccati.solve, part, system=DOUBLE, **changed)
        for changed, part in (
            ({"Q": np.eye(3)}, "matrix Q is (3, 3): give (2, 2)"),
            ({"Q": np.diag([1.0, np.nan])}, "matrix Q has nan for v, v: give finite numbers"),
            ({"R": np.zeros((1, 1))}, "matrix R has the eigenvalue 0: it must be positive definite"),
            ({"R": {"u9": 1.0}}, "the weight R names 'u9', which is not one of u"),
            ({"N": np.full((2, 1), np.nan)}, "2 states and 1 inputs need a finite one"),
        )
    ),
    call(
        riccati.solve,
        "the model has 2 states and 0 inputs: it needs at least one of each",
        R=np.zeros((0, 0)),
        system=DOUBLE.select(("x",), ()),
    ),
    *(
        call(weights.semidefinite, part, what="Q", value=value, names=("x", "v"))
        for value, part in (
            (np.eye(3), "the matrix Q is (3, 3): give (2, 2), its diagonal or a weight by name"),
            ([[1.0, 2.0], [0.0, 1.0]], "Q is not symmetric: [0, 1] is 2.0, [1, 0] is 0.0; give (M + M') / 2"),
            (["a", "b"], "entries of the weight Q are no real numbers"),
            ({"x": 1j}, "entries of the weight Q of 'x' are no real numbers"),
            ({"x": [1.0, 2.0]}, "the weight Q of 'x' has shape (2,): give a number"),
            ([[0.0, 1.0], [1.0, 0.0]], "eigenvalue -1: it must be positive semidefinite"),
        )
    ),
]
TIMING = [
    call(lqg.from_measurement, "meets", plant=USUAL["system"]),
    call(lqg.predictor, "discretise or resample", gain=lqr.lqr(mass(), np.eye(2), np.eye(1)), estimator=held_mass()),
    call(
        reduced_observer.compensator,
        "meets",
        observer=PAIR,
        K=PAIR_GAIN,
        computed=StateSpace([[1]], [[1]], [[1]], [[0]], ("z",), ("f",), ("z",), Discrete(0.2)),
    ),
    call(kalman.discrete, "sample period", system=mass()),
    call(kalman.continuous, "discretise or resample", system=scalar(1, D), W=[1], V=[1]),
    call(kalman.kalmd, "continuous model", system=scalar(1, D), W=[1], V=[1]),
    call(kalman.kalmd, "period", period_s=0.0),
    call(square_root_kalman.predict, "continuous", system=(0.5, 1.0, 1.0, 0.0, C)),
    call(internal_model.leapfrog, "finite and positive", period_s=0.0),
    call(
        internal_model.augmented,
        "continuous time meets discrete time",
        plant=third([1, 0, 0], Discrete(2 * T)),
        exosystem=internal_model.in_time((0.0,), Discrete(T)),
    ),
    call(servo.controller, "meets", system=StateSpace(*[np.zeros((0, 0))] * 4, (), (), (), Discrete(1.0))),
    call(servo.controller, "", regulator=servo.lqr(REGULATED, (0.0,), np.ones(3), [1.0])),
    call(servo.lqrd, "continuous time meets discrete time of 0.1 s", system=replace(REGULATED, time=D)),
    call(servo.lqrd, "finite and positive", period_s=0.0),
]

test_a_call_of_the_regulation_raises_a_model_error = refusals(ModelError, MODEL)
test_a_call_of_the_regulation_raises_a_signal_error = refusals(SignalError, SIGNAL)
test_a_call_of_the_regulation_raises_a_timing_error = refusals(TimingError, TIMING)
