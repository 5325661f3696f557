"""Analysis of linear and nonlinear models: operating points, linearisation, loops and margins, norms, structure."""
