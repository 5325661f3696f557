"""Function approximation: certified minimax polynomials for functions of one variable."""
