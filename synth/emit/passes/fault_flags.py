"""Bits of the fault word that only one side of a condition sets are set on that side, without a flag for the other.

    word_k = f_k ? word_(k-1) | bit_k : word_(k-1),    f_k = c ? 0 : a_k,    k = 1 .. n
    word_n = c ? word_0 : inner_n,    inner_k = a_k ? inner_(k-1) | bit_k : inner_(k-1),    inner_0 = word_0

The same holds for f_k = c ? a_k : 0. A step that takes the other side of c tests none of the n flags. A signal f_k that
nothing else reads is a_k from then on. All choices on one condition become one `if`, which stands outside that side. So
an a_k that decides another choice keeps its flag, but for a state, whose test a_k != 0 is a condition of its own.

Simplification of truth values: what a law writes with 0 and 1 becomes the logic that it means. Every rule is exact.

    c ? 1 : 0  =  c,    c ? 0 : 1  =  not c                                 for a truth value c
    c ? 1 : b  =  c or b,    c ? a : 0  =  c and a                          for truth values, where c decides no more
    c ? a : (d ? a : b)  =  (c or d) ? a : b                                for a number a, where c and d decide no more
    0 < (c ? a : b)  =  c ? 0 < a : 0 < b                                   for whole numbers that are not negative
    not a < b  =  b <= a                                                    for whole numbers

A condition that decides several choices stays a choice: they become one `if`. So does one whose arm divides or has a
domain, because the condition may protect it.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from synth.emit.passes.fold import Folder
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LIBM, LOGICAL

_ZERO = Node("literal")
LEAST = 3  # tests; for two the LQG controller takes 1 % more instructions, because its parts are outlined differently


@dataclass(frozen=True)
class _Test:
    """A test of a flag that is a choice: the nodes of the word before and after it, of its bit, and of the flag.

    `condition` is that of the flag, `zero` the place of its operand that is 0, `set` the node of the other one, a_k.
    """

    before: int
    after: int
    bit: int
    flag: int
    condition: int
    zero: int
    set: int


def gather(p: Program) -> Program:
    """Return the program with one choice for each run of flags that are 0 on the same side of a condition."""
    runs, users, ends = list(_runs(p)), p.users(), p.ends()
    last = {run[-1].after: run for run in runs}
    alone = {t.flag: t.set for run in runs for t in run if users[t.flag] == [t.after] and t.flag not in ends}
    nodes, index = list[Node](), list[int]()
    for k, node in enumerate(p.nodes):
        if k in alone:
            index.append(index[alone[k]])
        elif k in last:
            index.append(_put_choice(nodes, p, last[k], index))
        else:
            nodes.append(node.renumbered(index))
            index.append(len(nodes) - 1)
    return p.with_nodes(tuple(nodes), index)


def _runs(p: Program) -> Iterator[list[_Test]]:
    """Yield each LEAST or more consecutive tests whose flags are 0 on the same side of the same condition."""
    users, ends, chain, place = p.users(), {*p.ends(), *(k for _, k in p.marks)}, list[tuple[int, _Test]](), 0
    for test in _tests(p):
        follows = bool(chain) and chain[-1][1].after == test.before and test.before not in ends
        place += not (follows and sorted(users[test.before]) == sorted((test.bit, test.after)))
        chain.append((place, test))
    for _, group in groupby(chain, lambda link: (link[0], link[1].condition, link[1].zero)):
        run = [test for _, test in group]
        if len(run) >= LEAST:
            yield run


def _tests(p: Program) -> Iterator[_Test]:
    """Yield the tests of flags that are 0 on one side of a condition and decide nothing on the other."""
    conditions = {node.args[0] for node in p.nodes if node.op == "choose"}
    for k, node in enumerate(p.nodes):
        if node.op != "choose":
            continue
        flag, bit, before = node.args
        choice = p.nodes[flag]
        if p.nodes[bit].op == "bit" and p.nodes[bit].args == (before,) and choice.op == "choose":
            shared = {i for i in (1, 2) if (a := choice.args[3 - i]) in conditions and p.nodes[a].op != "state"}
            zeros = [i for i in (1, 2) if p.nodes[choice.args[i]] == _ZERO and i not in shared]
            if zeros:
                yield _Test(before, k, bit, flag, choice.args[0], zeros[0], choice.args[3 - zeros[0]])


def _put_choice(nodes: list[Node], p: Program, run: Sequence[_Test], index: Sequence[int]) -> int:
    """Append the choice between the word before a run and the word after its tests, and return its node."""
    first = word = index[run[0].before]
    for test in run:
        is_set = index[test.set]
        if p.nodes[test.set].op == "state":
            nodes.append(Node("ne", (is_set, index[p.nodes[test.flag].args[test.zero]])))
            is_set = len(nodes) - 1
        nodes.append(Node("bit", (word,), value=p.nodes[test.bit].value))
        nodes.append(Node("choose", (is_set, len(nodes) - 1, word)))
        word = len(nodes) - 1
    arms = (first, word) if run[0].zero == 1 else (word, first)
    nodes.append(Node("choose", (index[run[0].condition], *arms)))
    return len(nodes) - 1


_PARTIAL = frozenset({"div", "inv", "table", "floor"}) | LIBM - {"fabs"}
_REVERSED = {"lt": "le", "le": "lt"}


def simplified(p: Program) -> Program:
    """Return a program that computes the same values, with simpler truth values."""
    return Flags(p).program()


class Flags:
    """The nodes of the new program, and where each old node is in it."""

    def __init__(self, p: Program) -> None:
        self.p, self.f = p, Folder()
        self.index: list[int] = []
        users, ends = p.users(), {*p.ends(), *(k for _, k in p.marks)}
        self.alone = [len(readers) == 1 and k not in ends for k, readers in enumerate(users)]
        self.decides = Counter(n.args[0] for n in p.nodes if n.op == "choose")
        self.truth: list[bool] = []
        self.whole: list[bool] = []
        self.partial: list[bool] = []
        for node in p.nodes:
            self._classify(node)

    def program(self) -> Program:
        """Return the new program; what has no simpler form stays as it is."""
        for node in self.p.nodes:
            simpler = self._simpler(node)
            if simpler is None:
                simpler = self.f.place(node.renumbered(self.index))
            self.index.append(simpler)
        return self.p.with_nodes(tuple(self.f.nodes), self.index)

    def _classify(self, node: Node) -> None:
        """Note whether a node is a truth value, a whole number that is not negative, and has operands with a domain."""
        arms = node.args[1:] if node.op == "choose" else node.args if node.op == "add" else ()
        number = node.op == "literal" and node.value >= 0 and float(node.value).is_integer()
        truth = node.op in LOGICAL or (node.op == "literal" and node.value in (0.0, 1.0))
        truth = truth or (node.op == "choose" and all(self.truth[a] for a in arms))
        whole = truth or number or (node.op == "state" and node.name in self.p.integers)
        self.truth.append(truth)
        self.whole.append(whole or (bool(arms) and all(self.whole[a] for a in arms)))
        self.partial.append(node.op in _PARTIAL or any(self.partial[a] for a in node.args))

    def _simpler(self, node: Node) -> int | None:
        if node.op == "choose":
            return self._choice(*node.args)
        if node.op == "lt" and self._number(node.args[0]) == 0 and self.whole[node.args[1]]:
            return self._positive(node.args[1])
        if node.op == "not" and self.alone[node.args[0]]:
            return self._reverse(self.p.nodes[node.args[0]])
        return None

    def _choice(self, c: int, a: int, b: int) -> int | None:
        first, second, single = self._number(a), self._number(b), self.decides[c] == 1
        if self._is_logical(c) and (first, second) == (1, 0):
            return self.index[c]
        if single and self._is_logical(c) and (first, second) == (0, 1):
            return self._not(self.index[c])
        if single and self._is_logical(c) and (first == 1 or second == 0):
            other = b if first == 1 else a
            if self._is_logical(other) and not self.partial[other]:
                return self._place("or" if first == 1 else "and", self.index[c], self.index[other])
        inner = self.p.nodes[b]
        if single and first is not None and inner.op == "choose" and inner.args[1] == a and self.alone[b]:
            return self._join(c, b)
        return None

    def _join(self, c: int, inner: int) -> int | None:
        """Return the choice of the same number under either of two conditions, the second that of an inner choice."""
        d, a, _ = self.p.nodes[inner].args
        if self.decides[d] > 1 or self.partial[d]:
            return None
        made = self.f.nodes[self.index[inner]]
        if made.op != "choose" or made.args[1] != self.index[a]:
            return None
        return self._place("choose", self._place("or", self.index[c], made.args[0]), *made.args[1:])

    def _positive(self, k: int) -> int:
        """Return whether whole node k is above 0; a sum of flags stays a sum, which needs no branch."""
        node = self.p.nodes[k]
        if self._is_logical(k):
            return self.index[k]
        if (number := self._number(k)) is not None:
            return self.f.literal(float(number > 0))
        if node.op == "choose" and self.alone[k]:
            arms = tuple(self._positive(a) for a in node.args[1:])
            return self.f.make(Node("choose", (self.index[node.args[0]], *arms)))
        return self._place("lt", self.f.literal(0.0), self.index[k])

    def _reverse(self, node: Node) -> int | None:
        if node.op not in _REVERSED or not all(self.whole[a] for a in node.args):
            return None
        return self._place(_REVERSED[node.op], *(self.index[a] for a in reversed(node.args)))

    def _is_logical(self, k: int) -> bool:
        return self.truth[k] and self._number(k) is None

    def _number(self, k: int) -> float | None:
        return self.p.nodes[k].value if self.p.nodes[k].op == "literal" else None

    def _not(self, k: int) -> int:
        return self.f.make(Node("not", (k,)))

    def _place(self, op: str, *args: int) -> int:
        return self.f.place(Node(op, args))
