"""C back end: layout of the structs, local variables, expressions, statements, header and manifest."""
