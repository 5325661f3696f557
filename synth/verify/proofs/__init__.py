"""Proofs of the emitted C by Frama-C's Eva, fuzzing, cppcheck and hostile inputs."""
