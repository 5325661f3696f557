"""Local variables of a step: which values need one, their names, and which choices share one (variable coalescing).

A value that is read once is printed inside the expression that reads it; the others are locals. A signal of the
composition keeps its name, and a value that only becomes the next value of a state is named after the state. A choice
that starts from the value of another choice and replaces it uses the same variable.
"""

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from synth.block import Block
from synth.emit.c import diagnostics
from synth.emit.c.expressions import ACCEPTED, INLINE, RESERVED, WORD, constant
from synth.emit.passes.schedule import Assign, Branch, Let, Statement, Store
from synth.emit.program.lower import Node, Program

LOADS = ("input", "state")
SUMS = ("add", "sub")


class Names:
    """Unique C identifiers: `taken` are those already in use."""

    def __init__(self, taken: set[str]) -> None:
        self.taken = taken

    def free(self, stem: str) -> str:
        """Return an unused name that begins with `stem`, and reserve it."""
        name, n = stem, 2
        while name in self.taken:
            name, n = f"{stem}_{n}", n + 1
        self.taken.add(name)
        return name


@dataclass(frozen=True, eq=False)
class Locals:
    """By node: number of reads in the text, name, the choice whose variable it shares, its initial value.

    `direct_loads` are the loads that are assigned before any store: the expression may read the member itself.
    `at_once` are those that one statement reads or returns, without a branch between: a sum goes on, or it assigns.
    `next_only` are nodes whose only name is that of a next state. `stored` maps a node that is only stored to the state
    which then holds it for the others.
    """

    reads: Counter[int]
    name: dict[int, str]
    shared: dict[int, int]
    starts: dict[int, int | None]
    direct_loads: set[int]
    identifiers: Names
    next_only: set[int]
    stored: dict[int, str]
    at_once: set[int]


def assign(block: Block, program: Program, statements: Sequence[Statement], kinds: Sequence[str]) -> Locals:
    """Return the locals of scheduled statements."""
    reads: Counter[int] = Counter()
    _count(program, statements, reads)
    starts = {c: start for b in _branches(statements) for c, start in b.choices}
    shared = _shared_variables(program, statements, kinds, starts)
    taken = {*RESERVED, *(constant(c.name) for c in block.constants)}
    taken |= {n.name for n in program.nodes if n.op == "polynomial"}
    taken |= {constant(n.name) for n in program.nodes if n.op == "table"}
    taken |= {n.name for n in program.nodes if n.op in ("argument", "parameter")}
    taken |= {struct for struct, _ in program.members.values()}
    taken |= {c.parameters for c in program.calls.values()} | {ACCEPTED}
    names = Names(taken)
    name = _name_nodes(program, names, shared)
    marked = {program.word, *(k for _, k in program.marks), *starts, *shared.values()}
    next_only = name.keys() - marked
    stored = _next_states_alone(program, statements, kinds, reads, name.keys() - next_only)
    loads = set(_direct_loads(program, statements)) | _replaced_loads(program, stored, reads)
    return Locals(
        reads,
        name,
        shared,
        starts,
        loads,
        names,
        next_only,
        stored,
        {*_at_once(program, program.users(), statements), *program.returns.values()},
    )


def _at_once(p: Program, users: Sequence[Sequence[int]], block: Sequence[Statement]) -> set[int]:
    """Return the nodes that a sum goes on with, or that are assigned or stored, before the next branch.

    Behind a branch a compiler would hold the operands for longer than the result.
    """
    near, computed = set[int](), set[int]()
    for s in block:
        if isinstance(s, Branch):
            computed.clear()
            near |= _at_once(p, users, s.then) | _at_once(p, users, s.other)
        elif isinstance(s, Let):
            first = p.nodes[s.node].args[:1] if p.nodes[s.node].op in SUMS else ()
            near |= {a for a in first if a in computed and p.nodes[a].op in SUMS and len(users[a]) == 1}
            computed.add(s.node)
        elif s.node in computed:
            near.add(s.node)
    return near


def _name_nodes(p: Program, names: Names, shared: dict[int, int]) -> dict[int, str]:
    """Return the names of the nodes that are signals, the fault word or next states."""
    named: dict[int, str] = {}
    roots = [(mark.signal.name, node) for mark, node in p.marks]
    guarded = any(n.op == "guarded" for n in p.nodes)  # the guards set bits of the variable of this name
    roots += [] if p.word is None else [("fault_word" if guarded else WORD, p.word)]
    taken = {n.name for n in p.nodes if n.op in LOADS} | {mark.signal.name for mark, _ in p.marks}
    roots += [(name, node) for name, node in p.returns.items() if node not in p.next.values()]
    for name, node in ((name, _carrier(p, name, node)) for name, node in p.next.items()):
        label = p.labels.get(node, "")
        roots.append((label if label and label not in taken else f"{name}_next", node))
    for name, node in roots:
        if node not in named and p.nodes[node].op not in (*LOADS, *INLINE) and not _is_member(p, p.nodes[node]):
            named[node] = names.free(name)
    for node, root in shared.items():
        if node in named and root not in named:
            named[root] = named[node]
    return named


def _is_member(p: Program, node: Node) -> bool:
    """Tell whether a node is one of several results of a call, which have the names of a struct's members."""
    return node.op == "result" and len(p.calls[node.name.split(".")[0]].routine.results) > 1


def _carrier(p: Program, state: str, k: int) -> int:
    """Return the new value of a state inside choices that otherwise leave it unchanged."""
    while p.nodes[k].op == "choose":
        changed = [a for a in p.nodes[k].args[1:] if p.nodes[a] != Node("state", name=state)]
        if len(changed) != 1:
            break
        k = changed[0]
    return k


def _shared_variables(
    p: Program, statements: Sequence[Statement], kinds: Sequence[str], starts: dict[int, int | None]
) -> dict[int, int]:
    """Map each choice to the choice whose variable it can overwrite.

    That is the choice whose value it starts from, if every other reader of this value only leads to the new choice.
    A value that the diagnostics read at the end of its block is not overwritten.
    """
    shared: dict[int, int] = {}
    watched = diagnostics.of_program(p)
    ends, outer = {*p.ends(), *watched.signals, *watched.limited}, _enclosing(statements)
    users = [[u for u in readers if p.nodes[u].op != "accepted"] for readers in p.users()]
    written = {*starts, *_definitions(statements)}
    implicit = {k for k, n in enumerate(p.nodes) if n.op == "choose" and k not in written}  # in another one's branch
    for branch in _branches(statements):
        inside = set(_definitions((*branch.then, *branch.other)))
        for c, start in branch.choices:
            if start is None or (start not in starts and p.nodes[start].op != "guarded") or kinds[start] != kinds[c]:
                continue
            assigned = {d for d in outer[c] if starts[d] == start and shared.get(d) == shared.get(start, start)}
            if _leads_only_to(users, ends, start, {c, *assigned}, inside | assigned | implicit):
                shared[c] = shared.get(start, start)
    return shared


def _enclosing(block: Sequence[Statement], outer: tuple[int, ...] = ()) -> dict[int, tuple[int, ...]]:
    """Return by choice the choices of the branches that it is in."""
    enclosing: dict[int, tuple[int, ...]] = {}
    for branch in (s for s in block if isinstance(s, Branch)):
        declared = tuple(c for c, _ in branch.choices)
        enclosing |= dict.fromkeys(declared, outer)
        enclosing |= _enclosing((*branch.then, *branch.other), (*outer, *declared))
    return enclosing


def _leads_only_to(
    users: Sequence[Sequence[int]], ends: set[int], start: int, choices: set[int], inside: set[int]
) -> bool:
    """Tell whether every use of node `start` leads to one of `choices`, through nodes inside its branch."""
    seen, stack = set(choices), [start]
    while stack:
        k = stack.pop()
        if k in ends:
            return False
        further = set(users[k]) - seen
        if not further <= inside:
            return False
        seen |= further
        stack += further
    return True


def _branches(block: Sequence[Statement]) -> Iterator[Branch]:
    for s in block:
        if isinstance(s, Branch):
            yield s
            yield from _branches(s.then)
            yield from _branches(s.other)


def _direct_loads(p: Program, block: Sequence[Statement]) -> Iterator[int]:
    """Yield the loads that are assigned before any store, for which the expression may read the member itself."""
    loaded: set[int] = set()
    for s in block:
        if isinstance(s, Let) and p.nodes[s.node].op in LOADS:
            loaded.add(s.node)
        elif isinstance(s, Assign) and s.node in loaded:
            yield s.node
        elif isinstance(s, Branch):
            yield from _direct_loads(p, s.then)
            yield from _direct_loads(p, s.other)
        if isinstance(s, Store | Branch):
            loaded.clear()


def _next_states_alone(
    p: Program, block: Sequence[Statement], kinds: Sequence[str], reads: Counter[int], named: Collection[int]
) -> dict[int, str]:
    """Return the unnamed nodes that the text only stores, in one block, each with the first state that it becomes.

    Its store can stand where the node is computed, as no load of the state follows there.
    """
    stored: dict[int, str] = {}
    stores: dict[int, list[tuple[int, Store]]] = {}
    for place, s in enumerate(block):
        if isinstance(s, Store):
            stores.setdefault(s.node, []).append((place, s))
    for place, s in enumerate(block):
        if isinstance(s, Branch):
            stored |= _next_states_alone(p, s.then, kinds, reads, named) | _next_states_alone(
                p, s.other, kinds, reads, named
            )
        printed = isinstance(s, Let) and p.nodes[s.node].op not in (*LOADS, "result", "row")
        if not isinstance(s, Let) or not printed or s.node in named or kinds[s.node] != "real":
            continue
        of_node = stores.get(s.node, [])
        states = [(i, t.name) for i, t in of_node if t.struct == "state" and t.name not in p.integers]
        if states and reads[s.node] == len(of_node) > 1:
            last, state = states[0]
            between = {p.nodes[k] for k in _definitions(block[place:last])}
            stored |= {} if Node("state", name=state) in between else {s.node: state}
    return stored


def _replaced_loads(p: Program, stored: dict[int, str], reads: Counter[int]) -> set[int]:
    """Return the loads that only the value reads which then replaces them in the state."""
    loads = {k: n.name for k, n in enumerate(p.nodes) if n.op == "state" and reads[k] == 1}
    return {a for k, state in stored.items() for a in p.nodes[k].args if loads.get(a) == state}


def local_nodes(s: Statement) -> tuple[int, ...]:
    """Return the nodes whose variables a statement declares."""
    return (s.node,) if isinstance(s, Let) else tuple(c for c, _ in s.choices) if isinstance(s, Branch) else ()


def _definitions(block: Sequence[Statement]) -> Iterator[int]:
    for s in block:
        yield from local_nodes(s)
        if isinstance(s, Branch):
            yield from _definitions((*s.then, *s.other))


def _count(p: Program, block: Sequence[Statement], reads: Counter[int]) -> None:
    """Count how often the text reads each node, backwards, because a node without readers is not printed."""
    for s in reversed(block):
        if isinstance(s, Let) and (reads[s.node] or p.nodes[s.node].op in ("call", "guard")):
            node = p.nodes[s.node]
            reads.update(_printed_operands(p, node))
        elif isinstance(s, Assign | Store):
            reads[s.node] += 1
        elif isinstance(s, Branch):
            _count(p, s.other, reads)
            _count(p, s.then, reads)
            reads.update([s.condition, *(start for _, start in s.choices if start is not None)])


def _printed_operands(p: Program, node: Node) -> Sequence[int]:
    if node.op == "call":
        return node.args[: len(p.calls[node.name].routine.arguments)]
    if node.op == "guard":
        return [a for a in node.args[:-1] if p.nodes[a].op != "state"]
    if node.op == "within":
        return node.args[:1]
    return node.args[::2] if node.op == "clamp" else node.args * (2 if node.op == "sq" else 1)
