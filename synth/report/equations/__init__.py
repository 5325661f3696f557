"""Equations of plants and Blocks for the report, derived from their CasADi expressions.

derive         a plant or a Block as named SymPy equations; `symbolic` chooses what gets a name
mathml         an expression as presentation MathML; `mathml_value` reads it back
proof          what is shown is what CasADi computes, at random points
copies         equations that are alike but for their names
display        blocks of a page
"""
