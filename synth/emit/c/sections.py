"""Sections of a step: which Block of the composition a statement belongs to, and the comment that opens its section."""

from synth.emit.c.lines import opening, prose
from synth.emit.lower import Program
from synth.emit.passes.owners import Owners
from synth.emit.passes.statements import Branch, Statement


class Sections:
    """The sections of a program's text as it is printed, each tagged with the title of its Block."""

    def __init__(self, p: Program) -> None:
        self.titles = {owner: prose(title) for owner, title in p.titles.items()}
        self.equations = {self.titles[part]: rows for part, rows in p.equations.items()}
        self.owners, self.opened = Owners(p), set[str]()

    def tag(self, s: Statement, owner: str, tag: str) -> tuple[str, str]:
        """Return the owner and the tag of a statement behind those given."""
        owner = self.owners.of(s, owner) or owner
        return owner, self.titles.get(owner, tag or "next states")

    def joint_title(self, s: Branch) -> str:
        """Return the title of a branch of several short sections, "" for another one."""
        titles = [self.titles[owner].partition(": ") for owner in self.owners.together(s)]
        about = {title[2] for title in titles}
        return ", ".join(title[0] for title in titles) + (f": {about.pop()}" if len(about) == 1 else "")

    def open(self, heading: str) -> list[str]:
        """Return the comment that opens a section, with the equations the first time."""
        title = f"{heading} (continued)" if heading in self.opened else heading
        self.opened.add(heading)
        return opening([title], self.equations.pop(heading, ()))
