"""NumPy references of what controllers share: guard, safe output, fault handling, common laws, and precise gains.

A stage's `reference.py` computes one step of its controller, independently of the toolkit that emits it. Its own laws
are written there, from their equations; what it has in common with other stages is here. These modules import NumPy,
mpmath and each other, but nothing else of the toolkit, and nothing of the toolkit imports them: a test checks both.

States, inputs and outputs are columns (n,) by name, of n independent controllers.
"""
