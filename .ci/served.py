# ruff: noqa: UP030, UP031
"""Refuse, in one line, a Python that synth does not serve or that cannot make an environment. Any Python reads it."""

import sys

OLDEST, NEWEST = (3, 11, 2), (3, 15)
FAULTY = ((3, 13, 0), (3, 13, 1), (3, 13, 2))  # they crash where a traced frame is read (CPython issue 128396)
FIX = "name another one, as in `make build PYTHON=python3.12`"

if sys.version_info[:3] < OLDEST or sys.version_info[:2] > NEWEST or sys.version_info[:3] in FAULTY:
    served = "{0}.{1}.{2} to {3}.{4} without 3.13.0 to 3.13.2".format(*(OLDEST + NEWEST))
    sys.exit("synth needs Python %s, found %s: %s" % (served, ".".join(map(str, sys.version_info[:3])), FIX))
try:
    import ensurepip  # noqa: F401
    import venv  # noqa: F401
except ImportError:
    sys.exit(
        "%s cannot make an environment: install its venv (Debian, Ubuntu: `apt install python3-venv`), or %s"
        % (sys.executable, FIX)
    )
