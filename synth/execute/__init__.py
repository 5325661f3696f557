"""Execution of the emitted C on this machine and on emulated Cortex-M cores."""
