# SPDX-License-Identifier: BSD-3-Clause
"""The two tables of the benchmark, in Markdown."""


class Table:
    def __init__(self, *head):
        self.head = head
        self.rows = []

    def add(self, *cells):
        self.rows.append(cells)

    def text(self):
        lines = [self.head, tuple("---" for _ in self.head), *self.rows]
        return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


class Bars:
    """Measured figures against the bars that the project set itself."""

    def __init__(self):
        self.table = Table("recording", "what", "measured", "bar", "")

    def at_most(self, name, what, measured, bar, unit):
        self._add(name, what, measured, "≤", bar, unit, measured <= bar)

    def at_least(self, name, what, measured, bar, unit):
        self._add(name, what, measured, "≥", bar, unit, measured >= bar)

    def without(self, name, what, measured, unit):
        """A figure that belongs beside the others and for which no bar was set."""
        self.table.add(name, what, f"{measured:.3g} {unit}".strip(), "", "")

    def _add(self, name, what, measured, sign, bar, unit, met):
        self.table.add(name, what, f"{measured:.3g} {unit}".strip(), f"{sign} {bar:g} {unit}".strip(),
                       "met" if met else "**missed**")

    def text(self):
        return self.table.text()
