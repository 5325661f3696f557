"""Where sensors are in the body: the published layout and those that were searched for, grids of poses, their cost.

    cost = max over poses of max(s_places, lever s_angles)    for yaws to either side, in m

of (X, Y, yaw), or of all six coordinates of a level body. The lever says how far from the body's origin a turn counts
as a displacement. `observability.placement` searched for places of the least cost, and `fisher.worst` proves what a
planar result is worth, between the points of the grid too.

Three sensors of two axes have as many voltages as a body has coordinates. Their determinant D(X, Y) = det H is
continuous over the pitch, and where it takes both signs it vanishes on curves between: rank is lost on these. `signs`
shows it for a layout; the search for one with a single sign finds none. Four sensors lose rank where three further
equations hold: at isolated points of X, Y and yaw, of which a layout may have none. Of five, each four that are left
would have to be free of such points; one more than that leaves five, which are.
"""

from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from designs.hall_position.accuracy import fisher, six_field
from designs.hall_position.glsdc import parameters, six_parameters
from designs.hall_position.glsdc.parameters import Pair
from models import hall_accuracy
from synth import numeric
from synth.analyse.observability import information
from synth.errors import ModelError
from synth.statespace import readonly

Numbers = NDArray[np.float64]
Array = parameters.Array | six_parameters.Array
AnyArray = TypeVar("AnyArray", parameters.Array, six_parameters.Array)
Places = tuple[Pair, ...]  # in pitches

LEVER = 25.4e-3  # m, half a pitch
REACH = 0.64  # pitches, of the searches: as far as the published layout
PUBLISHED: Places = ((-0.375, -0.375), (0.375, 0.375), (0.640, 0.613))  # the third was added to (3)
LAYOUTS: dict[int, Places] = {  # by the yaws in degrees to either side; at worst, by proof, in um and urad:
    5: ((-0.132, 0.173), (0.106, -0.066), (0.385, -0.344)),  # 4.87, 5.14, 217, where PUBLISHED has 7.7, 7.0, 238
    15: ((0.269, -0.214), (-0.230, 0.285), (0.019, 0.035)),  # 4.83, 4.68, 258, where PUBLISHED has 199, 29, 4379
}
# Within 5 degrees, by proof, at worst 3.89, 4.21 um and 178 urad, and 10.83, 10.05, 366 after the loss of any one.
SPARE: Places = ((0.281, -0.091), (-0.012, -0.404), (0.440, 0.215), (-0.244, 0.292))
# In six degrees of freedom, by the number of sensors. Their cost for yaws within 5 degrees, on grids of 90 by 90 by 11:
# 4.9, 6.0 and 4.7 um. After the loss of any sensor five leave 224 um, though more than 20 um in a hundredth of the
# pitch only, and six 12.7 um.
SPATIAL: dict[int, Places] = {
    4: ((0.359, -0.581), (-0.420, -0.535), (-0.460, 0.236), (0.316, 0.196)),
    5: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322)),
    6: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322), (-0.530, -0.337)),
}


class Signs(NamedTuple):
    """The least and the largest determinant of three sensors over the pitch, in units of its mean size."""

    least: float
    largest: float


def placed(array: AnyArray, places: ArrayLike | Places) -> AnyArray:
    """Return an array with its sensors at places in the body's plane, in pitches; raise ModelError for no places."""
    at = [(x * array.pitch, y * array.pitch) for x, y in numeric.rows("places", places, 2)]
    if isinstance(array, parameters.Array):
        return replace(array, positions=tuple(at), weights=())
    return replace(array, positions=tuple((x, y, 0.0) for x, y in at))


def poses(pitch: float, points: int, yaws: ArrayLike = 0.0, shift: float = 0.0) -> Numbers:
    """Return a grid (3, N) of X, Y in m and yaws in rad over a pitch in m, X changing slowest, by `shift` of a step.

    Raises ModelError for no points, or a yaw that is not finite.
    """
    points = numeric.whole("the number of poses along the pitch", points)
    turns = numeric.table("the yaws", np.reshape(yaws, (-1, 1)), 1)[:, 0]
    along = pitch * (np.arange(points) + shift) / points
    return readonly([each.ravel() for each in np.meshgrid(along, along, turns, indexing="ij")])


def level(array: six_parameters.Array, q: Numbers) -> Numbers:
    """Return poses (N, 6) of a level body at the array's height, at X, Y and yaws (3, N)."""
    none = np.zeros_like(q[0])
    return readonly(np.column_stack([q[0], q[1], none + array.height, none, none, q[2]]))


def jacobians(array: Array, q: Numbers) -> Numbers:
    """Return the Jacobians (N, 2 sensors, 3 or 6) in V/m and V/rad at q (3, N), rows sensor by sensor."""
    if isinstance(array, six_parameters.Array):
        return six_field.rows(array, level(array, q))
    w, n = array.wave_number, len(array.positions)
    H = fisher.rows(array, np.array([w * q[0], w * q[1], q[2]])).jacobian / fisher.units(array)[:, None, None]
    return H.reshape(3, 2, n, -1).transpose(3, 2, 1, 0).reshape(-1, 2 * n, 3)


def cost(array: Array, q: Numbers, lever: float = LEVER, spare: bool = False) -> float:
    """Return the largest deviation over q (3, N), m, angles at the lever; with `spare` after any sensor's loss."""
    H = jacobians(array, q)
    return information.largest_deviation(H, array.deviation, hall_accuracy.sizes(H.shape[2], lever), 2 if spare else 0)


def signs(array: six_parameters.Array, yaw: float = 0.0, points: int = 100) -> Signs:
    """Return between which determinants of H a pitch at one yaw in rad lies, of an array of three sensors.

    Raises ModelError for another number of sensors, whose H is not square.
    """
    if len(array.positions) != 3:
        raise ModelError(f"{len(array.positions)} sensors have no determinant: give three")
    D = np.linalg.det(jacobians(array, poses(array.pitch, points, yaw)) / hall_accuracy.sizes(6, array.pitch))
    mean = np.abs(D).mean()
    return Signs(float(D.min() / mean), float(D.max() / mean))
