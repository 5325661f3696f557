"""Layouts of sensors in the body, with the least cost (`studies.hall.layout_accuracy`) that the search has reached.

Coordinates are in pitches. `fisher.worst` proves the worst deviation of a planar layout, also between grid points.

Three two-axis sensors have as many voltages as a body has coordinates. Their determinant D(X, Y) = det H is continuous
over the pitch. Where it takes both signs it vanishes on curves in between, on which rank is lost: so it is for every
layout that was looked at, and a search for one with a single sign has found none. Four sensors lose rank where three
further equations hold: at isolated points of X, Y and yaw, and a layout may have none. With five sensors, every four of
them would have to be free of such points; with six, every five are.
"""

from models.hall_array import Pair

Places = tuple[Pair, ...]  # in pitches

SEARCH_RADIUS = 0.64  # pitches, bound of the searches: as far as the published layout
LAYOUTS: dict[int, Places] = {  # by the yaws in degrees to either side; proved worst deviations in um and urad:
    5: ((-0.132, 0.173), (0.106, -0.066), (0.385, -0.344)),  # 4.87, 5.14, 217, where PUBLISHED has 7.7, 7.0, 238
    15: ((0.269, -0.214), (-0.230, 0.285), (0.019, 0.035)),  # 4.83, 4.68, 258, where PUBLISHED has 199, 29, 4379
}
# In six degrees of freedom, by the number of sensors. Their cost for yaws within 5 degrees, on grids of 90 by 90 by 11:
# 4.9, 6.0 and 4.7 um. After the loss of any sensor: 224 um of five, but more than 20 um in a hundredth of the pitch
# only, and 12.7 um of six.
SPATIAL: dict[int, Places] = {
    4: ((0.359, -0.581), (-0.420, -0.535), (-0.460, 0.236), (0.316, 0.196)),
    5: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322)),
    6: ((0.336, -0.636), (-0.330, -0.506), (-0.508, 0.302), (0.346, 0.186), (0.045, 0.322), (-0.530, -0.337)),
}
