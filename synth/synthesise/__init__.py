"""Synthesis of gains, observers and regulators; each result certifies itself. The names are imported when used.

State feedback is added: u = K x. MATLAB and python-control subtract it: their K is `-gain.K`.

State feedback
    lqr(system, Q, R)                     optimal gain in the model's own time
    lqrd(system, Q, R, period_s)          optimal gain of a held input, exact cost between the samples
    with_integrators(system, outputs)     the model with integrals of outputs, for `lqr`
    place(system, poles)                  gain for given poles of the closed loop
    solve_riccati(system, Q, R)           the Riccati equation with its certificate

Observers
    kalman(system, W, V)                  steady-state Kalman filter in the model's own time
    kalmd(system, W, V, period_s)         discrete Kalman filter of a continuous model
    lqg(gain, estimator)                  controller of a gain and a Kalman filter, with one period of delay
    reduced_observer(system, measured, L) observer of the states that are not measured, for a gain L

Regulators
    internal_model(frequencies)           exosystem: the steps and sines that the regulator rejects
    servo(system, exosystem, Q, R)        state feedback around copies of the exosystem, optimal
    servo_discrete(system, exosystem, Q, R, period_s)   the same for a held input
    back_calculation(regulator, decay_per_s)   its anti-windup

Nonlinear plants and measurements
    feedback_linearise(plant)             inputs that make the outputs chains of integrators
    fit_linear(equations, ...)            parameters of equations that are linear in them
    fit_equations(plant, log, ...)        parameters from logged derivatives
    fit_trajectory(plant, log, ...)       parameters from logged trajectories
"""

from synth.base import lazy

__getattr__, __dir__, __all__ = lazy.exports(__name__, __file__)
