"""The text of C: layout of the structs, locals, expressions, statements, header and manifest."""
