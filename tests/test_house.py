"""The house keeps its rooms small, and its page names them all."""

from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("solvers", "sot", "tasks", "sim", "scenarios")
MAX_FILES, MAX_LINES = 15, 400

CODE = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]


def test_a_folder_holds_at_most_fifteen_files():
    files = Counter(path.parent.relative_to(ROOT) for path in CODE if path.name != "__init__.py")
    assert files
    assert {str(folder): count for folder, count in files.items() if count > MAX_FILES} == {}


def test_a_file_holds_one_idea():
    lines = {str(path.relative_to(ROOT)): len(path.read_text("utf-8").splitlines()) for path in CODE}
    assert {name: count for name, count in lines.items() if count > MAX_LINES} == {}


def test_the_page_of_the_house_names_every_room():
    page = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    rooms = {path.parent.relative_to(ROOT).as_posix() for path in CODE if path.name != "__init__.py"}
    unnamed = sorted(room for room in rooms if f"`{room}/`" not in page and f"`{room}`" not in page)
    assert unnamed == []
