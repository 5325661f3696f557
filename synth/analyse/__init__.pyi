from synth.analyse.discretise import delay_samples as delay_samples
from synth.analyse.discretise import inverse_zero_order_hold as d2c
from synth.analyse.discretise import tustin as tustin
from synth.analyse.discretise import zero_order_hold as c2d
from synth.analyse.loops.disk import of_loop as disk_margin
from synth.analyse.loops.feedback_loop import close as sensitivity
from synth.analyse.loops.feedback_loop import feedback as feedback
from synth.analyse.loops.interconnect import connect as connect
from synth.analyse.loops.stability_margins import of_loop as margins
from synth.analyse.loops.transfer import response as frequency_response
from synth.analyse.loops.transfer import with_delay_and_hold as with_delay_and_hold
from synth.analyse.operating_points import linearise as linearise
from synth.analyse.operating_points import trim as trim
from synth.analyse.structure.gramian import gramians as gramians
from synth.analyse.structure.realisation import minimal as minreal
from synth.analyse.structure.structure import poles as poles
from synth.analyse.structure.structure import transmission_zeros as zeros
from synth.analyse.time_response import forced_response as forced_response
from synth.analyse.time_response import impulse_response as impulse_response
from synth.analyse.time_response import step_response as step_response

__all__ = [
    "c2d",
    "connect",
    "d2c",
    "delay_samples",
    "disk_margin",
    "feedback",
    "forced_response",
    "frequency_response",
    "gramians",
    "impulse_response",
    "linearise",
    "margins",
    "minreal",
    "poles",
    "sensitivity",
    "step_response",
    "trim",
    "tustin",
    "with_delay_and_hold",
    "zeros",
]
