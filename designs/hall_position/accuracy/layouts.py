"""Where sensors are in the body: those of the least `hall_accuracy.cost` that were found.

Coordinates are in pitches. `hall_fisher.worst` proves what a planar layout is worth, between the points of a grid too.

Three sensors of two axes have as many voltages as a body has coordinates. Their determinant D(X, Y) = det H is
continuous over the pitch, and where it takes both signs it vanishes on curves between: rank is lost on these.
`hall_accuracy.signs` shows it for a layout; the search for one with a single sign finds none. Four sensors lose rank
where three further equations hold: at isolated points of X, Y and yaw, of which a layout may have none. Of five, each
four that are left would have to be free of such points; one more than that leaves five, which are.
"""

from models.hall_array import Pair

Places = tuple[Pair, ...]  # in pitches

REACH = 0.64  # pitches, of the searches: as far as the published layout
LAYOUTS: dict[int, Places] = {  # by the yaws in degrees to either side; at worst, by proof, in um and urad:
    5: ((-0.132, 0.173), (0.106, -0.066), (0.385, -0.344)),  # 4.87, 5.14, 217, where PUBLISHED has 7.7, 7.0, 238
    15: ((0.269, -0.214), (-0.230, 0.285), (0.019, 0.035)),  # 4.83, 4.68, 258, where PUBLISHED has 199, 29, 4379
}
# Within 5 degrees, by proof, at worst 3.89, 4.21 um and 178 urad, and 10.83, 10.05, 366 after the loss of any one.
REDUNDANT: Places = ((0.281, -0.091), (-0.012, -0.404), (0.440, 0.215), (-0.244, 0.292))
# In six degrees of freedom, by the number of sensors. Their cost for yaws within 5 degrees, on grids of 90 by 90 by 11:
# 4.9, 6.0 and 4.7 um. After the loss of any sensor five leave 224 um, though more than 20 um in a hundredth of the
# pitch only, and six 12.7 um.
SPATIAL: dict[int, Places] = {
    4: ((0.359, -0.581), (-0.420, -0.535), (-0.460, 0.236), (0.316, 0.196)),
    5: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322)),
    6: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322), (-0.530, -0.337)),
}
