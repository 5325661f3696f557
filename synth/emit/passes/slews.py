"""Rate limits: max(min(target, last + step), last - step) becomes one node `slew` of (last, target, step)."""

from dataclasses import replace

from synth.emit.program.lower import Program


def slewed(p: Program) -> Program:
    """Return the program with a node for each rate limit whose two sums have no other user."""
    users = p.users()
    nodes = list(p.nodes)
    for k, node in enumerate(p.nodes):
        args = _slew(p, users, k) if node.op == "max" else None
        if args is not None:
            nodes[k] = replace(node, op="slew", args=args)
    return p.with_nodes(tuple(nodes), range(len(nodes)))


def _slew(p: Program, users: list[list[int]], k: int) -> tuple[int, int, int] | None:
    """Return the last value, the target and the step of a rate limit, None for another node."""
    upper, lower = p.nodes[k].args
    if p.nodes[upper].op != "min" or p.nodes[lower].op != "sub":
        return None
    target, raised = p.nodes[upper].args
    last, step = p.nodes[lower].args
    sums_up = p.nodes[raised].op == "add" and p.nodes[raised].args == (last, step)
    alone = all(len(users[n]) == 1 and n not in p.ends() for n in (upper, lower, raised))
    return (last, target, step) if sums_up and alone else None
