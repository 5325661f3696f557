from synth.synthesise.feedback.lqr import lqr as lqr
from synth.synthesise.feedback.lqr import lqrd as lqrd
from synth.synthesise.feedback.lqr import with_integrators as with_integrators
from synth.synthesise.feedback.pole_placement import place as place
from synth.synthesise.identify.identify import fit_equations as fit_equations
from synth.synthesise.identify.identify import fit_linear as fit_linear
from synth.synthesise.identify.identify import fit_trajectory as fit_trajectory
from synth.synthesise.nonlinear.feedback_linearisation import of_plant as feedback_linearise
from synth.synthesise.observers.kalman import kalman as kalman
from synth.synthesise.observers.kalman import kalmd as kalmd
from synth.synthesise.observers.lqg import predictor as lqg
from synth.synthesise.observers.reduced_observer import from_gain as reduced_observer
from synth.synthesise.regulation.anti_windup import back_calculation as back_calculation
from synth.synthesise.regulation.internal_model import exosystem as internal_model
from synth.synthesise.regulation.servo import lqr as servo
from synth.synthesise.regulation.servo import lqrd as servo_discrete
from synth.synthesise.riccati.riccati import solve as solve_riccati

__all__ = [
    "back_calculation",
    "feedback_linearise",
    "fit_equations",
    "fit_linear",
    "fit_trajectory",
    "internal_model",
    "kalman",
    "kalmd",
    "lqg",
    "lqr",
    "lqrd",
    "place",
    "reduced_observer",
    "servo",
    "servo_discrete",
    "solve_riccati",
    "with_integrators",
]
