from synth import analyse as analyse
from synth import synthesise as synthesise
from synth.block import Block as Block
from synth.block import Constant as Constant
from synth.block import State as State
from synth.block import Step as Step
from synth.block import build as build_block
from synth.composition import compose as compose
from synth.errors import SynthError as SynthError
from synth.law import call as call
from synth.law import label as label
from synth.plant import Plant as Plant
from synth.plant import build as build_plant
from synth.signals import Parameter as Parameter
from synth.signals import Signal as Signal
from synth.statespace import StateSpace as StateSpace
from synth.timing import Continuous as Continuous
from synth.timing import Discrete as Discrete

__version__: str

__all__ = [
    "Block",
    "Constant",
    "Continuous",
    "Discrete",
    "Parameter",
    "Plant",
    "Signal",
    "State",
    "StateSpace",
    "Step",
    "SynthError",
    "analyse",
    "build_block",
    "build_plant",
    "call",
    "compose",
    "label",
    "synthesise",
]
