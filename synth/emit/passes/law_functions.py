"""Functions that a law calls: what the function of a Block has in functions of its called.

Ownership follows the order of the calls, as when Python evaluates the law. A call begins when its arguments are known
and ends with its results, so that no function waits for a later one.
"""

from collections import defaultdict
from dataclasses import replace

from synth.emit.passes.parts import BOTH, FEWEST, IDLE, LEAVES, Form, Part, ancestors, form
from synth.emit.program.lower import Program
from synth.emit.proof.ranges import kinds


def alike(p: Program) -> list[list[tuple[Part, Form]]]:
    """Return the functions of a law, those with one canonical form together: each has the results of them all."""
    by_form: dict[tuple[object, ...], list[tuple[Part, Form]]] = defaultdict(list)
    kind = kinds(p)
    for part in _functions(p):
        of_values = form(p, replace(part, results=()), kind)
        by_form[of_values.shape[: len(of_values.nodes)]].append((part, of_values))
    groups = []
    for several in by_form.values():
        places = sorted({made.nodes.index(k) for part, made in several for k in part.results})
        parts = [replace(part, results=tuple(made.nodes[i] for i in places)) for part, made in several]
        groups.append([(part, form(p, part, kind)) for part in parts])
    return groups


def _functions(p: Program) -> list[Part]:
    """Return a Part for each function that the law of a Block, or one of its functions, calls itself.

    As in the law, what the arguments of a call need is computed before it by the caller, or by earlier functions, and
    the rest of what its results need by the function. What a later function needs as well, which does without the
    results of this one, the caller has.
    """
    computed = [*range(len(p.nodes))]  # what a choice that the Block makes for its result stands for
    for k, node in enumerate(p.nodes):
        computed[k] = computed[max(node.args[1:])] if node.op == "choose" and node.value == IDLE else k
    called = {path: f.renumbered(computed) for path, f in p.functions.items() if "." not in path}
    needs = {path: ancestors(p, {*f.results}, range(len(p.nodes))) for path, f in called.items()}
    before = {path: ancestors(p, {*f.arguments}, range(len(p.nodes))) for path, f in called.items()}
    done = {k for k, node in enumerate(p.nodes) if node.op in LEAVES}
    users, ends, made = p.users(), {*p.ends()}, list[Part]()
    for path, f in called.items():
        done |= before[path]
        region = needs[path] - done
        for other in [*called][[*called].index(path) + 1 :]:
            if needs[other].isdisjoint({*f.results} & region):
                region -= ancestors(p, region & needs[other], region)
        done |= needs[path]
        if len(region) >= FEWEST:
            roots = tuple(k for k in f.results if k in region)
            results = tuple(sorted(k for k in region if k in ends or not region.issuperset(users[k])))
            made.append(Part(path, BOTH, frozenset(region), {}, results, {}, roots))
    return made
