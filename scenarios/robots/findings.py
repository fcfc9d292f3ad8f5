"""What will not work of a robot file: one list, the worst first, each with where it is and what to do."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from rich.console import Console
from rich.markup import escape
from rich.table import Table


class Severity(StrEnum):
    """How much depends on a finding."""

    STOPS = "stops"  # the robot cannot dance so
    WARNS = "warns"  # it can, but something will be worse than it need be
    NOTES = "notes"  # it should be known


ORDER = list(Severity)


@dataclass(frozen=True)
class Finding:
    """Something that was found.

    Attributes:
        severity: how much depends on it.
        what: is wrong, in words.
        where: part of the robot file, joints or links.
        remedy: what to do.
    """

    severity: Severity
    what: str
    where: str
    remedy: str


def stopping(findings: Sequence[Finding]) -> bool:
    """Whether the robot cannot dance so."""
    return any(finding.severity == Severity.STOPS for finding in findings)


def print_findings(findings: Sequence[Finding], console: Console) -> None:
    """Print findings as a table, the worst first; or that there are none."""
    if not findings:
        console.print("Checked: nothing found.")
        return
    table = Table(box=None, padding=(0, 2, 0, 0))
    for head in ("", "what", "where", "remedy"):
        table.add_column(head, overflow="fold")
    for each in sorted(findings, key=lambda finding: ORDER.index(finding.severity)):
        table.add_row(each.severity, *(escape(text) for text in (each.what, each.where, each.remedy)))
    console.print(table)
