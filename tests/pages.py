"""What the pages of documentation ask a reader to type, and what they say comes back."""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
PAGES = [README, *sorted((ROOT / "docs").rglob("*.md"))]


@dataclass(frozen=True)
class Command:
    """A line after "$ " of a console block, continuation lines joined, and the lines of output that are shown."""

    line: str
    shown: tuple[str, ...]


def blocks(page: Path, language: str) -> list[str]:
    """Contents of the page's fenced blocks of a language."""
    fence = rf"^```{re.escape(language)}\n(.*?)^```"
    return re.findall(fence, page.read_text("utf-8"), re.MULTILINE | re.DOTALL)


def commands(page: Path) -> list[Command]:
    """The page's console blocks, command by command."""
    found: list[Command] = []
    for line in "".join(blocks(page, "console")).replace("\\\n", " ").splitlines():
        if line.startswith("$ "):
            found.append(Command(line.removeprefix("$ "), ()))
        elif line.strip():
            found[-1] = Command(found[-1].line, (*found[-1].shown, line))
    return found
