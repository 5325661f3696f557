"""Control laws as Blocks: linear models, regulators, lead-lag, biquads, jerk-limited set-points, lookup tables, maps of
errors, and servo axes: `axis`.

The gain of the anti-windup is `synthesise.regulation.anti_windup`; it reads the excess that `stage.compose.limits`
or, behind an inverse, `axis_regulator` gives.
"""
