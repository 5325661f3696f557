"""Equations of plants and Blocks for the report, derived from their CasADi expressions.

derive         a plant or a Block as named SymPy equations; `symbolic` selects the subexpressions that get a name
mathml         an expression as presentation MathML
proof          comparison of the displayed expressions with CasADi at random points
copies         equations of equal form that differ only in names
display        blocks of a page
"""
