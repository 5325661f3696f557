"""Analysis of linear and nonlinear models. The names below are imported once they are used.

Operating points
    trim(plant, fixed, free)             the equilibrium of a plant: inputs and states at rest
    linearise(plant, point)              A, B, C, D at an operating point, from exact derivatives

Linear models
    c2d(system, period_s)                zero-order hold
    d2c(system)                          the continuous model of a zero-order hold
    tustin(system, period_s, frequency)  trapezoidal rule, exact at a frequency
    delay_samples(system, samples)       a sampled model with delayed inputs
    connect(models, inputs, ...)         models wired by the names of their signals
    feedback(forward, back)              the closed loop with negative feedback
    minreal(system)                      the model without uncontrollable and unobservable states
    poles(system)                        with damping, frequency and the states that take part
    zeros(system)                        transmission zeros
    gramians(system)                     controllability and observability Gramians, Hankel singular values

Loops
    with_delay_and_hold(system, ...)     a continuous loop with an exact delay and hold
    margins(loop)                        gain, phase, delay and modulus margins with all crossings, verified
    disk_margin(loop)                    the gain and phase that may change together, certified
    sensitivity(plant, controller)       L, S, T, PS and CS of the closed loop
    frequency_response(loop)             L at frequencies in rad/s

Responses
    step_response(system, duration_s)    the response to a unit step at each input
    impulse_response(system, duration_s) the response to a unit impulse at each input
    forced_response(system, inputs, ...) the response to samples of the inputs, from any initial state
"""

from synth.base import lazy

__getattr__, __dir__, __all__ = lazy.exports(__name__, __file__)
