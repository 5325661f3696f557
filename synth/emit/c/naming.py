"""Names of values without a signal: made from the operation and its operands, else from the signal that they serve.

force_x - force_y        force_x_minus_force_y
y * y                    y_squared
2 * y, 0.3 * y           twice_y, y_scaled
value of a polynomial, its argument     cos_phi, cos_phi_argument
comparison with a constant              above_limit, below_limit
comparison with a whole number          left_at_least_3, left_above_3, left_positive
choices that change a state             left_next
fault word on its way              faults_before
what the law labels                     its label

A value with a longer name, on the way to the signal `r_1`, has a name from what becomes of it, else from what it is:

r_1 on one side of a condition          r_1_if_ready
operand of a sum that is r_1            r_1_without_y4, r_1_change where it is added to a state
operand of a limit, a quotient, a root  r_1_unlimited, r_1_numerator, r_1_radicand
any other                               r_1_sum, r_1_product, r_1_test and so on
"""

import re
from collections.abc import Iterator, Mapping

from synth.emit.c.locals import LOADS
from synth.emit.program.lower import Node, Program
from synth.emit.program.operations import LOGICAL

LONGEST = 28
_POLYNOMIAL = "_polynomial"
_BETWEEN = {"add": "plus", "sub": "minus", "mul": "times", "div": "over", "lt": "below", "le": "upto", "and": "and"}
_BETWEEN |= {"or": "or", "min": "min", "max": "max"}
_AFTER = {"sq": "squared", "clamp": "limited", "fabs": "size", "sqrt": "root", "neg": "negated", "floor": "whole"}
_FACTORS = {0.5: "half", 2.0: "twice", 0.25: "quarter"}
_OPERATIONS = {"add": "sum", "sub": "sum", "mul": "product", "choose": "choice", "div": "quotient", "inv": "inverse"}
_OPERATIONS |= {"clamp": "limited", "sq": "square", "min": "limited", "max": "limited", "slew": "limited"}
_LIMITS, _SUMS = ("min", "max", "clamp"), ("add", "sub")


class Naming:
    """Makes names for the nodes of a program; `named` holds those that have one, and grows as names are given."""

    def __init__(self, p: Program, named: Mapping[int, str], shared: Mapping[int, int]) -> None:
        self.p, self.named = p, dict(named)
        self.sharing: dict[int, list[int]] = {}
        for choice, root in shared.items():
            self.sharing.setdefault(root, []).append(choice)
        self.changes = {k: state for state, end in p.next.items() for k in _changing_choices(p, state, end)}
        self.served = _signal_of_node(p)
        self.made: set[str] = set()
        self.signals = {k: mark.signal.name for mark, k in reversed(p.marks)}
        self.users = p.users()

    def name(self, k: int) -> str:
        """Return a name for node k and the choices that share its variable, which may be in use."""
        node, sharing = self.p.nodes[k], [*self.sharing.get(k, ())[::-1], k]
        states = [self.changes[c] for c in sharing if c in self.changes]
        if label := next((self.p.labels[c] for c in sharing if c in self.p.labels), ""):
            return label
        made = (f"{states[0]}_next" if states else "") or self._function(k) or self._made(node)
        if not made or len(made) > LONGEST:
            made = self._by_signal(k) if self.served[k] else self._last_resort(node)
        return made

    def _by_signal(self, k: int) -> str:
        """Return a name from the signal that a value serves and what becomes of it, else from what it is."""
        node, signal = self.p.nodes[k], self.served[k]
        roles = (f"{signal}_{role}" for u in self.users[k] if (role := self._role(k, u)))
        fitting = next((name for name in roles if len(name) <= LONGEST), "")
        truth = node.op in LOGICAL or node.op == "accepted" or self._is_truth(node)
        return fitting or f"{signal}_{'test' if truth else _OPERATIONS.get(node.op, 'part')}"

    def _role(self, k: int, user: int) -> str:
        """Return what a node is to the named value of one that reads it, "" for nothing that a word says."""
        reader, named = self.p.nodes[user], user in self.named or user in self.signals
        if reader.op == "choose" and reader.args[0] != k:
            condition = self._operand(reader.args[0])
            return f"if_{'' if reader.args[1] == k else 'not_'}{condition}" if condition else ""
        if reader.op in ("sqrt", "div"):
            return {"sqrt": "radicand"}.get(reader.op, "numerator" if reader.args[0] == k else "denominator")
        if reader.op == "add" and reader.args[1] == k and self.p.nodes[reader.args[0]].op == "state":
            return "change"
        if named and reader.op in _LIMITS and reader.args[0] == k:
            return "unlimited"
        if named and reader.op in _SUMS and reader.args[0] == k != reader.args[1]:
            other = self._operand(reader.args[1])
            return f"without_{other}" if other else ""
        return ""

    def _last_resort(self, node: Node) -> str:
        bits = any(self.p.nodes[a].op == "bit" for a in node.args)
        return "faults_before" if bits else "value"

    def width(self, text: str) -> int:
        """Return the length of a text in which each name made here counts as two letters: it decides nothing."""
        return len(text) - sum(len(word) - 2 for word in re.findall(r"\w+", text) if word in self.made)

    def _is_truth(self, node: Node) -> bool:
        return node.op == "choose" and any(self.p.nodes[a].op in LOGICAL for a in node.args[1:])

    def _function(self, k: int) -> str:
        """Return a name for a sine, for a comparison with a constant, for the value of a polynomial or its argument."""
        node, readers = self.p.nodes[k], [self.p.nodes[u] for u in self.users[k]]
        operands = [self.p.nodes[a] for a in node.args]
        odd = [n.name for n in operands if n.op == "polynomial" and self.p.polynomials[n.name].parity == "odd"]
        if node.op == "polynomial" or (node.op == "mul" and odd):
            return (odd[0] if odd else node.name).removesuffix(_POLYNOMIAL)
        if node.op in ("lt", "le") and "constant" in (operands[0].op, operands[1].op):
            first = operands[0].op == "constant"
            return f"above_{operands[0].name}" if first else f"below_{operands[1].name}"
        if node.op in ("lt", "le") and "literal" in (operands[0].op, operands[1].op):
            return self._comparison(node, operands)
        if node.op in ("sin", "cos") and self._operand(node.args[0]):
            return f"{node.op}_{self._operand(node.args[0])}"
        if readers and all(n.op == "polynomial" for n in readers):
            signal = next((self.signals[u] for u in self.users[k] if u in self.signals), "")
            return f"{signal or readers[0].name.removesuffix(_POLYNOMIAL)}_argument"
        return ""

    def _comparison(self, node: Node, operands: list[Node]) -> str:
        """Return a name for a comparison with a whole number, "" for another one."""
        first = operands[0].op == "literal"
        number, compared = operands[0 if first else 1].value, self._operand(node.args[1 if first else 0])
        if not compared or not number.is_integer() or number < 0:
            return ""
        if number == 0:
            return f"{compared}_{'positive' if node.op == 'lt' else 'not_negative'}" if first else ""
        words = {("lt", True): "above", ("le", True): "at_least", ("lt", False): "below", ("le", False): "at_most"}
        return f"{compared}_{words[node.op, first]}_{int(number)}"

    def _made(self, node: Node) -> str:
        """Return a name made from an operation and the names of its operands, "" where one of them has none."""
        args = [self._operand(a) for a in node.args]
        if node.op == "mul" and len(set(node.args)) == 1 and args[0]:
            return f"{args[0]}_squared"
        if node.op == "mul" and self.p.nodes[node.args[0]].op == "literal":
            factor = _FACTORS.get(self.p.nodes[node.args[0]].value, "")
            return "" if not args[1] else f"{factor}_{args[1]}" if factor else f"{args[1]}_scaled"
        if not all(args):
            return ""
        if node.op in _AFTER:
            return f"{args[0]}_{_AFTER[node.op]}"
        if node.op == "inv":
            return f"inverse_{args[0]}"
        return f"{args[0]}_{_BETWEEN[node.op]}_{args[1]}" if node.op in _BETWEEN else ""

    def _operand(self, k: int) -> str:
        node = self.p.nodes[k]
        if node.op in LOADS:
            owner = self.p.owner(node.name)
            return node.name.removeprefix(f"{owner}_") if owner else node.name
        if k in self.named:
            return self.named[k].removesuffix("_held").removesuffix("_next").removesuffix("_accepted")
        return node.name.split(".")[-1] if node.op in ("argument", "result", "constant", "parameter") else ""


def _changing_choices(p: Program, state: str, k: int) -> Iterator[int]:
    """Yield the choices between a state and its change, from its next value inwards."""
    while p.nodes[k].op == "choose":
        changed = [a for a in p.nodes[k].args[1:] if p.nodes[a] != Node("state", name=state)]
        yield k
        if len(changed) != 1:
            break
        k = changed[0]


def _signal_of_node(p: Program) -> list[str]:
    """Return for each node the first signal, or else the state or output, that it is computed for."""
    names: dict[int, str] = {}
    for name, k in (*p.outputs.items(), *p.returns.items(), *p.next.items()):
        names[k] = name
    for mark, k in reversed(p.marks):
        names[k] = mark.signal.name
    served: list[str] = [""] * len(p.nodes)
    nearest: list[int] = [len(p.nodes)] * len(p.nodes)
    for k in range(len(p.nodes) - 1, -1, -1):
        if k in names:
            nearest[k], served[k] = k, names[k]
        for a in p.nodes[k].args:
            if nearest[k] < nearest[a]:
                nearest[a], served[a] = nearest[k], served[k]
    return served
