"""Emission: a Block becomes C99, a manifest and gains. `pipeline` shows every pass."""
