"""The tests that every design gets: what is committed, the evidence, and defects that are planted."""

from synth.testing import *  # noqa: F403
