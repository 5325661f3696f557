"""Operations of CasADi under the names that they have in a program, and what kind of operations they are."""

import casadi as ca

UNARY = {
    ca.OP_NEG: "neg",
    ca.OP_EXP: "exp",
    ca.OP_LOG: "log",
    ca.OP_SQRT: "sqrt",
    ca.OP_SQ: "sq",
    ca.OP_TWICE: "twice",
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_TAN: "tan",
    ca.OP_ASIN: "asin",
    ca.OP_ACOS: "acos",
    ca.OP_ATAN: "atan",
    ca.OP_SINH: "sinh",
    ca.OP_COSH: "cosh",
    ca.OP_TANH: "tanh",
    ca.OP_FABS: "fabs",
    ca.OP_ASINH: "asinh",
    ca.OP_ERF: "erf",
    ca.OP_EXPM1: "expm1",
    ca.OP_LOG1P: "log1p",
    ca.OP_INV: "inv",
    ca.OP_NOT: "not",
}
BINARY = {
    ca.OP_ADD: "add",
    ca.OP_SUB: "sub",
    ca.OP_MUL: "mul",
    ca.OP_DIV: "div",
    ca.OP_FMIN: "min",
    ca.OP_FMAX: "max",
    ca.OP_ATAN2: "atan2",
    ca.OP_FMOD: "fmod",
    ca.OP_REMAINDER: "remainder",
    ca.OP_LT: "lt",
    ca.OP_LE: "le",
    ca.OP_EQ: "eq",
    ca.OP_NE: "ne",
    ca.OP_AND: "and",
    ca.OP_OR: "or",
    ca.OP_IF_ELSE_ZERO: "when",
}
LOOKUP = (ca.OP_CONST, ca.OP_INPUT, ca.OP_GETNONZEROS_PARAM, ca.OP_OUTPUT)  # the instructions of a `block.table`
# Operations that need libm. Those of two arguments except atan2 are exact in every libm.
LIBM_OF_TWO = frozenset({"atan2", "fmod", "remainder"})
LIBM = LIBM_OF_TWO | {"exp", "expm1", "log", "log1p", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "fabs"}
LIBM |= {"sinh", "cosh", "tanh", "asinh", "erf"}
LOGICAL = frozenset({"lt", "le", "eq", "ne", "and", "or", "not"})
