"""The papers of the stages, as the C's headers and the reports cite them."""

FULFORD = (
    'C. Fulford, M. Maggiore, J. Apkarian, "Control of a 5DOF Magnetically Levitated Positioning Stage", IEEE '
    "Transactions on Control Systems Technology, 2009"
)
YU = 'H. Yu, W.-J. Kim, "Design of Precision Positioner with Hall-effect Sensors and Multivariable Control Methodology"'
KAWATO = (
    'Y. Kawato, W.-J. Kim, "A Novel Multi-DOF Precision Positioning Methodology Using Two-Axis Hall-Effect Sensors"'
)
