"""How far two ways to one number may differ: name -> (value, reason)."""

_EPS = 2.0**-52

TABLE: dict[str, tuple[float, str]] = {
    "last_bit": (_EPS, "two results rounded once each from hundreds of bits differ by one unit in the last place"),
    "half_bit": (_EPS / 2 * 1.01, "a correctly rounded matrix lies within half an ulp of the solution, seen to 1 %"),
    "double": (1e-12, "a few hundred operations in double precision on well-conditioned numbers of like size"),
    "pencil": (1e-8, "LAPACK's ordered Schur form on random Riccati pencils of order 5 or less loses half the digits"),
    "quadrature": (1e-10, "adaptive or composite Gauss quadrature of a smooth integrand"),
    "ode": (1e-8, "an adaptive Runge-Kutta solution at a relative tolerance of 1e-11, over a few time constants"),
    "flow": (1e-5, "four differentiations of an interpolated simulation lose ten digits of fifteen"),
    "frequency": (1e-9, "bracketing stops at 1e-12 of a frequency; the resonances here magnify that a thousandfold"),
    "peak": (1e-7, "a minimum is found to the root of the precision of its value"),
    "multiple_root": (1e-5, "the eigenvalues of a pole of multiplicity 2 or 3 scatter by a root of the precision"),
    "zeros": (1e-8, "zeros of random models of order 6 or less, found from two pencils, lose half the digits"),
    "lyapunov": (1e-9, "a Lyapunov equation of order 5 or less whose slowest mode is a tenth of its fastest"),
    "settled": (1e-9, "what is left of a transient after the 30 or more time constants simulated"),
    "libm_ulps": (8, "units: two functions of libm off by up to 3 each, their product and the rounding of the inputs"),
    "folded": (1e-13, "folding moves a few dozen roundings in double, and libm's functions differ in the last bit"),
    "placed": (1e-8, "a gain rounded to double moves poles of random pairs of order 5 or less by their condition, 1e7"),
    "print_K": (0.5, "units of the last printed digit: a figure that is rounded right is off by half of one"),
    "print_q": (0.1, "relative: poles printed to three digits determine the weights to several per cent"),
}


def of(name: str) -> float:
    """Return the tolerance called `name`."""
    return TABLE[name][0]
