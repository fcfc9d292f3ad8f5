"""Where a report comes from: the command line and the project's revision."""

import shlex
import subprocess
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGE = "humanoid-sot"
ROOT = Path(__file__).parents[2]
GIT_TIMEOUT_S = 10.0


def command_line() -> str:
    """The command line of this process, as a shell takes it; the program is `sot` if the project's own was started."""
    program = Path(sys.argv[0])
    own = program.name in ("sot", "sot.exe") or program.parts[-2:] == ("scenarios", "__main__.py")
    return shlex.join(["sot" if own else program.name or "python", *sys.argv[1:]])


@cache
def revision() -> str:
    """The git revision of the project's checkout, with "+" if files of it were changed; else the version installed."""
    if (ROOT / ".git").exists():
        head = _git("rev-parse", "--short=12", "HEAD")
        changes = _git("status", "--porcelain", "--untracked-files=no")
        if head:
            return f"{head}+" if changes else head
    try:
        return version(PACKAGE)
    except PackageNotFoundError:
        return "unknown"


def _git(*words: str) -> str:
    """What git says of the checkout; empty where there is no git, or it refuses."""
    command = ["git", "-C", str(ROOT), *words]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=GIT_TIMEOUT_S, check=False)
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
