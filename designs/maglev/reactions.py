"""What the maglev stage does after each failure, for the table in the C's header: who keeps which axis, and the end."""

from designs.maglev.commutation import DESCENT
from designs.maglev.handover import FADE, OF_AXIS
from designs.maglev.platen import BAD_SAMPLES, LIFTED, LOST, SAFE_CURRENT

(X_FIRST, X_SECOND), (Z_FIRST, Z_SECOND) = OF_AXIS["x"], OF_AXIS["z"]
ALL_GO_ON = "all axes go on"
AT_THE_END = (
    f"then all currents fade to 0 A, while the gap is above {LIFTED * 1e3:g} mm, where the magnets carry less than the "
    "weight"
)
LATCHES = f"the {BAD_SAMPLES}th sample in a row latches in flight, without a landing: i_d {SAFE_CURRENT:g} A, i_q 0 A"
HANDOVER = (
    f"lands; without x, motors {X_FIRST} and {X_SECOND} hand i_d over to {Z_FIRST} and {Z_SECOND} in {FADE} samples "
    f"and keep i_q, and vice versa without z; commutated at the prediction; {AT_THE_END}, and the lost position is "
    f"{LOST:g} m, which the phase step refuses"
)
REACTIONS = {
    "one_refused": ALL_GO_ON,
    "one_wrong": ALL_GO_ON,
    "unclear": f"lands, y, phi and theta by the readings as they are; {AT_THE_END}",
    "several_lost": "lands; what the remaining gaps leave open of y, phi, theta is predicted; x and z go on measured; "
    f"{AT_THE_END}",
    "too_many_lost": f"{LATCHES}, at measured angles",
    "single_refused": HANDOVER,
    "single_frozen": "as the row above; bit and exclusion stay",
    "single_jumps": "as the rows above; a single such sample sets the bit, and all axes go on",
    "singles_lost": f"{LATCHES}, {LOST:g} m for both: the phase step keeps the angles for {DESCENT} samples, then "
    f"fades all currents out in {FADE}",
    "set_point": "all axes go on to it",
}
MOTORS = "; ".join(f"u_{n} is i_q of motors {' and '.join(map(str, OF_AXIS[n]))}, along {n.upper()}" for n in "xz")
