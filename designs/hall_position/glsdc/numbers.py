"""Numbers in the law of the estimator of (X, Y, yaw) that the C names, with units and what they are made of.

w = 2 pi / pitch. The radius is the sensors' rms arm, in rad of phase by rad of yaw.
"""

from math import pi
from string import ascii_lowercase

from designs.hall_position.glsdc import channels, restarts, tracking
from designs.hall_position.glsdc.planar_model import Problem
from synth.block import Constant


def numbers(of: Problem) -> list[Constant]:
    """Return the numbers of the cost function, the arms, the gates and the tracker."""
    return [*_cost(of), *_geometry(of), *_gates(of), *_tracker(of)]


def _cost(of: Problem) -> list[Constant]:
    radius, ratio = of.array.radius, of.tuning.yaw_damping_ratio
    descent, half = of.descent, of.tuning.max_phase_step / 2
    return [
        Constant("damping", of.damping, "V^2", f"{of.tuning.damping:g} alpha^2: weight of the prior"),
        Constant("yaw_damping", of.damping * (ratio * radius) ** 2, "V^2", f"damping ({ratio:g} radius)^2"),
        Constant("squared_yaw_arm", (ratio * radius) ** 2, "1", f"({ratio:g} radius)^2"),
        Constant("undamped_yaw", of.damping * radius**2, "V^2", "damping radius^2"),
        Constant("cost_factor", 1 + descent.rounding, "1", "rise of the cost that rounding may cause"),
        Constant("cost_slack", descent.slack, "V^2", "rise of the cost that rounding may cause"),
        Constant("converged_decrease", descent.decrease_tolerance, "V^2", "a smaller decrease has converged"),
        Constant("max_yaw_step", descent.bounds[2].high, "rad", f"moves no sensor by more than {half:g} rad of phase"),
    ]


def _geometry(of: Problem) -> list[Constant]:
    array = of.array
    arms = {
        f"arm_{letter}{axis}": (place, f"w times the place of sensor {letter} from the centre, along {axis}")
        for letter, arm in zip(ascii_lowercase, array.arms, strict=False)
        for axis, place in zip("xy", arm, strict=True)
    }
    return [
        *(Constant(name, value, "rad", about) for name, (value, about) in arms.items()),
        *(Constant(f"centre_{a}", v, "m", "centre of the sensors") for a, v in zip("xy", array.centre, strict=True)),
        Constant("pitch", array.pitch, "m", "pitch of the magnet matrix"),
        Constant("metre_per_rad", 1 / array.wave_number, "m/rad", "1 / w"),
        Constant("wave_number", array.wave_number, "rad/m", "w"),
        Constant("squared_radius", array.radius**2, "1", "radius^2"),
    ]


def _gates(of: Problem) -> list[Constant]:
    array, tuning, sensors = of.array, of.tuning, len(of.array.positions)
    sigma, freedom = array.deviation, 2 * sensors - 3
    gate = tuning.innovation_gate_sigma * sigma / of.damping**0.5
    threshold = tuning.ambiguity_threshold * (tracking.REDUNDANCY_FACTOR if sensors > 2 else 1)
    alone = 1 if tracking.is_redundant(array) else freedom
    inconsistent = min(tuning.residual_limit, tracking.INCONSISTENT * sigma)
    return [
        Constant("deviation", sigma, "V", "standard deviation of a voltage"),
        Constant("deviation_over_w", sigma / array.wave_number, "V m/rad", "deviation / w"),
        Constant("innovation_gate", gate, "rad", f"{tuning.innovation_gate_sigma:g} deviation / sqrt(damping)"),
        Constant("squared_gate", gate**2, "rad^2", "innovation_gate^2"),
        Constant("squared_residual_limit", alone * tuning.residual_limit**2, "V^2", "above: a residual fault"),
        Constant("squared_inconsistent", alone * inconsistent**2, "V^2", "above: the voltages are inconsistent"),
        Constant("others_agree", 2 * (sensors - 1) * of.innovation_bound**2, "V^2", "innovations of healthy sensors"),
        Constant("contrast", tracking.CONTRAST, "1", "of squared innovations, to exclude a sensor"),
        Constant("damped_weight", tuning.max_prior_weight / of.damping, "1/V^2", "above: the pose is damped"),
        Constant("unambiguous_weight", threshold / of.damping, "1/V^2", "at most: the pose is unambiguous"),
        Constant("least_square", channels.ROOT_REGULARISATION, "V^2", "keeps the argument of a root positive"),
    ]


def _tracker(of: Problem) -> list[Constant]:
    tuning, limit = of.tuning, tracking.valid_yaw_limit(of.array, of.tuning)
    steps = {f"start_step_{axis}": 2 * pi * (1 - fraction) for axis, fraction in restarts.FRACTIONS.items()}
    return [
        Constant("yaw_gain", tuning.velocity_gain / tuning.yaw_damping_ratio, "1", "of a correction, in the motion"),
        Constant("yaw_limit", limit, "rad", "largest yaw that is valid"),
        Constant("ambiguous_yaw_limit", 2 * limit, "rad", "of a pose that is not yet unambiguous"),
        Constant("yaw_window", tuning.yaw_window, "rad", "about the last good yaw"),
        *(Constant(name, value, "rad", "from one start of the search to the next") for name, value in steps.items()),
    ]
