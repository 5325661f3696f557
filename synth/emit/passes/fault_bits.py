"""Bits of the fault word that only one side of a condition sets are set on that side, without a flag for the other.

    word_k = f_k ? word_(k-1) | bit_k : word_(k-1),    f_k = c ? 0 : a_k,    k = 1 .. n
    word_n = c ? word_0 : inner_n,    inner_k = a_k ? inner_(k-1) | bit_k : inner_(k-1),    inner_0 = word_0

The same holds for f_k = c ? a_k : 0. A step that takes the other side of c tests none of the n flags. A signal f_k that
nothing else reads is a_k from then on. All choices on one condition become one `if`, which stands outside that side. So
an a_k that decides another choice keeps its flag, but for a state, whose test a_k != 0 is a condition of its own.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from synth.emit.program.lower import Node, Program

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
