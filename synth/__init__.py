"""Symbolic modelling, controller synthesis and verified C for precision stages.

The names below are imported once they are used; `help(synth.analyse)` and `help(synth.synthesise)` list the libraries.

Models
    Signal, Parameter          a quantity with its unit and range; a constant of the physics
    Plant, build_plant         dx/dt = f(x, u, p), y = h(x, u, p) in CasADi; build one from a function
    StateSpace                 x' = A x + B u, y = C x + D u, with names and units of its signals
    Continuous, Discrete       the time of a model: continuous, or sampled with a period in seconds

Controllers for the C
    Block, State, Constant     a step function of a sampled system with bounded states
    build_block, Step          build one from a function
    label                      name expressions in that function for the C
    call                       call a function in that function, for which the C has one
    compose                    wire Blocks by the names of their signals

Packages
    analyse                    operating points, linearisation, loops, margins, structure
    synthesise                 gains, observers, servo regulators, feedback linearisation, identification

Errors
    SynthError                 the base of every error that this package raises; each says how to mend it
"""

from synth.base import lazy

__version__ = "0.1.0"
__getattr__, __dir__, __all__ = lazy.exports(__name__, __file__)
