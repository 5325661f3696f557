"""Parts: what each Block of a composition computes, as functions that a step calls in the order of data flow.

Every operation belongs to one Block: that of the nearest signal or next state that it is computed for. A Block becomes
one Part where nothing that it needs depends on it. Else, as a regulator with anti-windup, it becomes several that come
one after the other: each has what others need of what can be computed by then, and the last one has the rest. What
only one side of the latch needs is a Part of its own, as the step branches there.

List scheduling by Block: of the Blocks that can be completed the first one in the order of the composition is next;
where there is none, the first one of whose signals its own others depend on.

A state is stored by the last Part that reads or computes it, by the step where that Part also runs on a side that does
not store it. Two Parts are the same function when their expressions have one canonical form, in which the values from
elsewhere, the states, the constants and the numbers are counted in the order in which they are met.
"""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from synth.blocks.guard import safety
from synth.emit.program.lower import Node, Program
from synth.emit.proof.ranges import kinds

LEAVES = ("input", "state", "constant", "literal", "accepted", "argument", "parameter")
OF_STEP = ("guard", "guarded", "bit")  # operations that stay in the step
FEWEST = 4  # operations of a function that is worth its name
IDLE = 1.0  # value of a choice that a Block makes for its result
THEN, OTHER, BOTH = 0, 1, 2  # the sides of the latch that need a value


def by_node(p: Program) -> list[str]:
    """Return for each node the Block whose operation it is, "" for none.

    It is that of the first signal or next state that the node is computed for. A Block that so has few operations has
    those that it is the first one to need.
    """
    blocks = [*p.titles]
    ends = {k: p.owner(state) for state, k in reversed(p.next.items())} | {k: n.block for n, k in reversed(p.marks)}
    order = {block: i for i, block in enumerate(blocks)}
    owner, nearest, first = [""] * len(p.nodes), [len(p.nodes)] * len(p.nodes), [len(blocks)] * len(p.nodes)
    for k in range(len(p.nodes) - 1, -1, -1):
        if k in ends:
            nearest[k], owner[k], first[k] = k, ends[k], order.get(ends[k], len(blocks))
        for a in p.nodes[k].args:
            first[a] = min(first[a], first[k])
            if nearest[k] < nearest[a]:
                nearest[a], owner[a] = nearest[k], owner[k]
    sizes = Counter(block for block, node in zip(owner, p.nodes, strict=True) if node.op not in LEAVES)
    needed = [*map([*blocks, ""].__getitem__, first)]
    return [b if b and sizes[b] < FEWEST else a for a, b in zip(owner, needed, strict=True)]


@dataclass(frozen=True)
class Part:
    """What one Block computes at one place: region of nodes, the states that it stores, and what others read of it.

    `side` is the side of the latch that it is on, `local` maps the states that its function reaches to their names
    there, and `before` has the keys of the Parts that read a state which this one stores. `copies` are comparisons of
    its counts that stand elsewhere as well: an analyser relates no flag that it is passed to the count that it is from.
    """

    block: str
    side: int
    region: frozenset[int]
    next: Mapping[str, int]
    results: tuple[int, ...]
    local: Mapping[str, str]
    roots: tuple[int, ...]
    copies: frozenset[int] = frozenset()
    phase: str = ""
    before: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        return f"{self.block}_{self.phase}" if self.phase else self.block


@dataclass(frozen=True)
class Form:
    """A Part in canonical form: `shape` is equal for equal parts; the lists hold what may differ, in one order.

    `nodes` are all that it computes and reads.
    """

    shape: tuple[object, ...]
    arguments: tuple[int, ...]
    numbers: tuple[int, ...]
    results: tuple[int, ...]
    nodes: tuple[int, ...]


def latch(p: Program) -> int:
    """Return the node of the guard's latch, -1 without one."""
    return next((k for named, k in p.marks if (named.block, named.signal.name) == (safety.GUARD, "latched")), -1)


WORTH = 3  # operations that are skipped for a result that is 0 then


def with_idle_results(p: Program) -> Program:
    """Return the program in which what a Block gives to others is 0 where a condition tells that they do not read it.

    The Block then computes it on one side of that condition alone. The condition is a state, or the Block's own.
    """
    units, contexts, users = _units(p), _contexts(p), p.users()
    results_of = {k for k, unit in enumerate(units) if unit[0] and any(units[u] != unit for u in users[k])}
    skipping: dict[tuple[tuple[str, int], int, bool], set[int]] = defaultdict(set)
    reached: dict[int, set[int]] = {}
    for k in results_of:
        for condition, holds in contexts[k] or ():
            is_its_own = units[condition] == units[k] and k not in reached.setdefault(
                condition, ancestors(p, {condition}, range(len(p.nodes)))
            )
            if is_its_own or p.nodes[condition].op == "state":
                skipping[units[k], condition, holds].add(k)
    behind: dict[int, list[tuple[int, bool]]] = defaultdict(list)  # by result, the innermost condition first
    for (unit, condition, holds), results in sorted(skipping.items(), key=lambda item: -item[0][1]):
        sunk = set[int]()
        for k in range(len(p.nodes) - 1, -1, -1):
            if units[k] == unit and (k in results or (users[k] and sunk.issuperset(users[k]))):
                sunk.add(k)
        if len(sunk) >= WORTH * len(results):
            for k in results:
                behind[k].append((condition, holds))
    nodes, inside, outside = [Node("literal")], dict[int, int](), dict[int, int]()
    stack = [*range(len(p.nodes))][::-1]
    while stack:
        k = stack[-1]
        node, conditions = p.nodes[k], behind.get(k, ())
        missing = [a for a in (*node.args, *(c for c, _ in conditions)) if a not in inside]
        stack += missing
        if not missing:
            stack.pop()
        if missing or k in inside:
            continue
        args = tuple([(inside if units[a] == units[k] else outside)[a] for a in node.args])
        nodes.append(replace(node, args=args))
        inside[k] = outside[k] = len(nodes) - 1
        for condition, holds in conditions:
            arms = (outside[k], 0)
            nodes.append(Node("choose", (inside[condition], *(arms if holds else arms[::-1])), IDLE))
            outside[k] = len(nodes) - 1
    computed = {inside[k]: name for k, name in p.labels.items()}
    return p.with_nodes(tuple(nodes), [outside[k] for k in range(len(p.nodes))], computed)


def _contexts(p: Program) -> list[frozenset[tuple[int, bool]] | None]:
    """Return for each node the conditions, and whether they hold, without which nothing reads it; None for no reader.

    The latch, on which the step branches, is none of them.
    """
    users, held = p.users(), latch(p)
    contexts: list[frozenset[tuple[int, bool]] | None] = [None] * len(p.nodes)
    for k in p.ends():
        contexts[k] = frozenset()
    for k in range(len(p.nodes) - 1, -1, -1):
        at_end = contexts[k]
        each = [] if at_end is None else [at_end]
        for u in dict.fromkeys(users[k]):
            node, of_user = p.nodes[u], contexts[u]
            if of_user is None:
                continue
            places = [i for i, a in enumerate(node.args) if a == k]
            if node.op == "choose" and len(places) == 1 and places[0] and node.args[0] != held:
                condition, holds = node.args[0], places[0] == 1
                while p.nodes[condition].op == "not":
                    condition, holds = p.nodes[condition].args[0], not holds
                of_user |= {(condition, holds)}
            each.append(of_user)
        contexts[k] = frozenset.intersection(*each) if each else None
    return contexts


def parts(p: Program) -> list[Part]:
    """Return the Parts of a composition in the order in which a step calls them; a single Block has none."""
    if len(p.titles) < 2:
        return []
    order = _order(p, _units(p))
    place = {k: i for i, (_, region) in enumerate(order) for k in region}
    stores = _stores(p, order, place)
    stored_by: dict[int, dict[str, int]] = defaultdict(dict)
    for state, i, k in stores:
        stored_by[i][state] = k
    of_step = {state for state, i, _ in stores if i < 0}
    kept = {p.next[state] for state in p.next.keys() - of_step}  # choices that a call stands for
    ends = {*p.outputs.values(), *p.result_nodes(), *(k for _, i, k in stores if i < 0)}
    kept -= ends | {a for k, node in enumerate(p.nodes) if k not in kept for a in node.args}
    users = [[u for u in of if u not in kept or u in place] for of in p.users()]
    made: list[Part] = []
    for i, ((block, side), region) in enumerate(order):
        if len(region) < FEWEST and not stored_by[i]:
            continue
        passed = {k for _, j, k in stores if j != i}
        results = sorted(k for k in region if k in ends | passed or not region.issuperset(users[k]))
        stored = {s for s, j, _ in stores if j < i and {order[j][0][1], side} != {THEN, OTHER}} | of_step
        local = {s: s.removeprefix(f"{block}_") for s in p.next if p.owner(s) == block and s not in stored}
        roots = tuple(dict.fromkeys(k for _, k in p.marks if k in region))
        copies = _comparisons(p, region, local)
        made.append(Part(block, side, frozenset(region), stored_by[i], tuple(results), local, roots, copies))
    return _with_phases(p, made)


def _comparisons(p: Program, region: Collection[int], local: Mapping[str, str]) -> frozenset[int]:
    """Return the comparisons of a Block's own counts with numbers that a region reads and does not have."""
    counts = p.integers & local.keys()

    def is_own(node: Node) -> bool:
        return node.op in ("constant", "literal") or (node.op == "state" and node.name in counts)

    read = {a for k in region for a in p.nodes[k].args} - {*region}
    compared = (k for k in read if p.nodes[k].op in ("lt", "le", "eq", "ne"))
    return frozenset(k for k in compared if all(is_own(p.nodes[a]) for a in p.nodes[k].args))


def _with_phases(p: Program, made: Sequence[Part]) -> list[Part]:
    """Return the Parts with names for the phases, and the Parts that come before each for its stores."""
    named: list[Part] = []
    for part in made:
        of_side = [q for q in made if q.block == part.block and (q.side == THEN) == (part.side == THEN)]
        n = of_side.index(part) + 1
        phase = "output" if n == 1 else "update" if part is of_side[-1] else f"output_{n}"
        words = ["latched"] if part.side == THEN else []
        words += [phase] if len(of_side) > 1 else []
        near = [q for q in named if q.block == part.block and {q.side, part.side} != {THEN, OTHER}]
        read = [q for q in near if not part.next.keys().isdisjoint(_loads(p, q))]
        named.append(replace(part, phase="_".join(words), before=tuple(q.key for q in read)))
    return named


def _loads(p: Program, part: Part) -> set[str]:
    loads = {p.nodes[a].name for k in part.region for a in p.nodes[k].args if p.nodes[a].op == "state"}
    return loads & part.local.keys()


def _units(p: Program) -> list[tuple[str, int]]:
    """Return for each node its Block and the side of the latch that needs it, ("", BOTH) for one of the step."""
    owner, held = by_node(p), latch(p)
    needs: list[set[int]] = [set() for _ in p.nodes]
    for k in p.ends():
        needs[k] = {THEN, OTHER}
    of_step = _fault_word(p)
    for k in range(len(p.nodes) - 1, -1, -1):
        node = p.nodes[k]
        branches = node.op == "choose" and node.args[0] == held
        of_step |= {k} if branches or node.op in (*LEAVES, *OF_STEP) else set()
        for place, a in enumerate(node.args):
            needs[a] |= needs[k] & {place - 1} if branches and place else needs[k]
    guard = safety.GUARD if safety.GUARD in p.titles else ""
    sides = [BOTH if len(need) != 1 else min(need) for need in needs]
    users, tests = p.users(), defaultdict(list)
    for k, node in enumerate(p.nodes):
        readers = {(owner[u], sides[u]) for u in users[k]}
        if node.op == "accepted" and len(readers) == 1:
            tests[readers.pop()].append(k)
    of_step -= {k for several in tests.values() if len(several) >= FEWEST for k in several}
    units = [("", BOTH) if k in of_step else (owner[k] or guard, sides[k]) for k in range(len(p.nodes))]
    for k, node in enumerate(p.nodes):
        if node.op == "choose" and node.value == IDLE:
            units[k] = units[max(node.args[1:])]
    units = _small_ones_in_step(p, units)
    for k, node in enumerate(p.nodes):
        if node.op == "row":  # of an array that no function returns
            units[k] = units[node.args[0]]
    return units


def _small_ones_in_step(p: Program, units: list[tuple[str, int]]) -> list[tuple[str, int]]:
    """Return the units, without the few operations for an unnamed value that several Blocks read: the step has it."""
    users, named = p.users(), {*p.ends(), *(k for _, k in p.marks)}
    units = [*units]
    for k in range(len(p.nodes) - 1, -1, -1):
        readers = {units[u][0] for u in users[k]} - {"", units[k][0]}
        if units[k][0] and readers and k not in named:
            cone, stack = {k}, [*p.nodes[k].args]
            while stack:
                a = stack.pop()
                if units[a] == units[k] and a not in named and cone.issuperset(users[a]):
                    cone.add(a)
                    stack += p.nodes[a].args
            leaves = {a for c in cone for a in p.nodes[c].args} - cone
            if len(cone) < FEWEST and all(units[a] != units[k] for a in leaves):
                for a in cone:
                    units[a] = ("", BOTH)
    return units


def _fault_word(p: Program) -> set[int]:
    """Return the nodes of the fault word on its way."""
    nodes: set[int] = set()
    stack = [] if p.word is None else [p.word]
    while stack:
        k = stack.pop()
        if p.nodes[k].op in ("bit", "choose") and k not in nodes:
            nodes.add(k)
            stack += p.nodes[k].args[p.nodes[k].op == "choose" :]
    return nodes


_Order = list[tuple[tuple[str, int], set[int]]]


def _order(p: Program, units: Sequence[tuple[str, int]]) -> _Order:
    """Return the units in the order of their calls, each with the nodes that it computes there."""
    left: dict[tuple[str, int], list[int]] = {}
    for k in range(len(p.nodes)):
        if units[k][0]:
            left.setdefault(units[k], []).append(k)
    blocks = [*p.titles]
    names = sorted(left, key=lambda unit: (blocks.index(unit[0]), unit[1]))
    users, done, order = p.users(), set[int](), list[tuple[tuple[str, int], set[int]]]()

    def computable(nodes: Sequence[int]) -> set[int]:
        now = set[int]()
        for k in nodes:
            if all(a in done or a in now for a in p.nodes[k].args):
                now.add(k)
        return now

    contexts, left_of = _contexts(p), {unit: {*nodes} for unit, nodes in left.items()}
    steps, ready = [k for k in range(len(p.nodes)) if not units[k][0]], dict[tuple[str, int], set[int]]()
    touched = {*left}
    while left or len(done) < len(p.nodes):
        new = computable(steps)
        done |= new
        steps = [k for k in steps if k not in new]
        touched |= {units[u] for k in new for u in users[k]}
        ready |= {unit: computable(left[unit]) for unit in names if unit in touched and unit in left}
        touched = set[tuple[str, int]]()
        unit = next((u for u in names if u in left and len(ready[u]) == len(left[u])), None)
        if unit is None and left:
            waiting = [unit for unit in names if unit in left]
            exported = {u: {k for k in ready[u] if not left_of[u].issuperset(users[k])} for u in waiting}
            needed = {u: _leading(users, ks, left_of[u], {*left[u]} - ready[u]) for u, ks in exported.items()}
            unit = next((u for u in exported if needed[u]), None)
            if unit is None:
                unit = next(u for u in exported if exported[u])
                needed = exported
            known = done | ready[unit]
            decided = {k for k in exported[unit] if all(c in known for c, _ in contexts[k] or ())}
            now = ancestors(p, needed[unit] | decided, ready[unit])
            ready[unit] = now | {k for k in ready[unit] if p.nodes[k].op == "row" and p.nodes[k].args[0] in now}
        if unit is not None:
            now = ready.pop(unit)
            done |= now
            order.append((unit, now))
            touched = {unit, *(units[u] for k in now for u in users[k])}
            left[unit] = [k for k in left[unit] if k not in now]
            if not left[unit]:
                del left[unit]
    return order


def _leading(users: Sequence[Sequence[int]], sources: set[int], unit: set[int], targets: set[int]) -> set[int]:
    """Return the sources from which a way leads out of their unit and back to a target."""
    leads = set[int]()
    for source in sources:
        seen, stack = set[int](), [u for u in users[source] if u not in unit]
        while stack and source not in leads:
            k = stack.pop()
            if k in targets:
                leads.add(source)
            elif k not in seen:
                seen.add(k)
                stack += users[k]
    return leads


def ancestors(p: Program, roots: set[int], region: Collection[int]) -> set[int]:
    seen, stack = set(), list(roots)
    while stack:
        k = stack.pop()
        if k in region and k not in seen:
            seen.add(k)
            stack += p.nodes[k].args
    return seen


def _stored_values(p: Program) -> Iterator[tuple[str, int, int]]:
    """Yield each state, a side of the latch and the node that the state becomes there, where it is not kept."""
    held = latch(p)
    for state, k in p.next.items():
        node = p.nodes[k]
        of_sides = [(BOTH, k)]
        if node.op == "choose" and node.args[0] == held:
            of_sides = [(THEN, node.args[1]), (OTHER, node.args[2])]
        kept = (
            Node("state", name=state),
            Node("guard", p.nodes[k].args, p.nodes[k].value, state),
        )  # or stored by a guard
        yield from ((state, side, a) for side, a in of_sides if p.nodes[a] not in kept)


def _stores(p: Program, order: _Order, place: Mapping[int, int]) -> list[tuple[str, int, int]]:
    """Return each state, the place in the order of what stores it, -1 for the step, and the node that it becomes."""
    ready = [-1] * len(p.nodes)  # the place of the last Part that a node waits for
    for k, node in enumerate(p.nodes):
        ready[k] = max([place.get(k, -1), *(ready[a] for a in node.args)])
    readers: dict[str, list[int]] = defaultdict(list)
    for i, ((block, _), region) in enumerate(order):
        loads = {p.nodes[a].name for k in region for a in p.nodes[k].args if p.nodes[a].op == "state"}
        for state in loads:
            if p.owner(state) == block:
                readers[state].append(i)
    stores: dict[str, list[tuple[int, int]]] = defaultdict(list)
    for state, side, k in _stored_values(p):
        of_block = [i for i, ((block, _), _) in enumerate(order) if block == p.owner(state)]
        of_block = [i for i in of_block if len(order[i][1]) >= FEWEST or i == place.get(k)]
        after = max([ready[k], *(i for i in readers[state] if order[i][0][1] in (side, BOTH))])
        fits = (i for i in of_block if i >= after and order[i][0][1] == side)
        stores[state].append((next(fits, -1), k))
    return [
        (state, i if all(j >= 0 for j, _ in of_state) else -1, k)
        for state, of_state in stores.items()
        for i, k in of_state
    ]


def form(p: Program, part: Part, kind: Sequence[str]) -> Form:
    """Return the canonical form of a Part; `kind` holds the kinds of all nodes."""
    places: dict[int, int] = {}
    shape: list[tuple[object, ...]] = []  # an entry a node, which refers to others by their places
    arguments: list[int] = []
    numbers: list[int] = []

    def leaf(k: int) -> tuple[object, ...]:
        node = p.nodes[k]
        if node.op in ("constant", "literal"):
            numbers.append(k)
            return (node.op, node.value if node.op == "constant" else 0.0)
        if node.op == "state" and node.name in part.local:
            return ("state", part.local[node.name])
        arguments.append(k)
        return ("argument", kind[k])

    def visit(k: int) -> int:
        if k not in places:
            node = p.nodes[k]
            if k in part.region or k in part.copies:
                entry = (node.op, node.name, node.value, k in part.results, *(visit(a) for a in node.args))
            else:
                entry = leaf(k)
            places[k] = len(shape)
            shape.append(entry)
        return places[k]

    roots = [k for k in part.roots if k in part.region]
    ends = [*map(visit, roots)]
    ends += [visit(k) for k in part.results if k not in places]
    stores = [(part.local[state], visit(k)) for state, k in part.next.items()]
    results = tuple(k for k in places if k in part.results)
    return Form((*shape, *ends, *stores), tuple(arguments), tuple(numbers), results, tuple(places))


def alike(p: Program) -> list[list[tuple[Part, Form]]]:
    """Return the Parts, those with one canonical form together: each group becomes one function."""
    by_form: dict[tuple[object, ...], list[tuple[Part, Form]]] = defaultdict(list)
    kind = kinds(p)
    for part in parts(p):
        made = form(p, part, kind)
        states = sorted(s.removeprefix(part.block) for s in p.next if p.owner(s) == part.block)
        by_form[(part.phase, *states, *made.shape)].append((part, made))
    return [*by_form.values()]
