"""Broken robot files and models, hundreds of them: each is a robot, or is refused in one line."""

import random
import re
from pathlib import Path

import pytest

from sot.errors import InputError
from sot.robots.models import hrp2
from sot.robots.robot import Robot
from tests.sot.robots import urdf_robot

QUICK, THOROUGH = 24, 500
VALUES = ('"half"', "3", "-1.5", "nan", "inf", "true", "[]", "{}", "[1, 2]", '""', "1e30", "1979-05-27", "[[0, 0, 0]]")
NUMBERS = ("nan", "-1", "0", "1e9", "1e-12", "x", "", "0.5 0.5", "inf")
NAMES = ("world", "floor", "BODY", "LARM3", "left_foot", "", "nobody", "RLEG5_LINK", "ä")


def mutated_file(text: str, rng: random.Random) -> str:
    """A robot file with a line dropped, doubled, moved, cut, or with a key or value of another kind."""
    lines = text.splitlines()
    k = rng.choice([k for k, line in enumerate(lines) if line.strip()])
    match rng.randrange(8):
        case 0:
            del lines[k]
        case 1:
            lines.insert(rng.randrange(len(lines)), lines[k])
        case 2:
            lines.insert(rng.randrange(len(lines)), lines.pop(k))
        case 3:
            lines[k] = lines[k][: rng.randrange(len(lines[k]))]
        case 4:
            lines[k] = re.sub(r"=.*", f"= {rng.choice(VALUES)}", lines[k])
        case 5:
            lines[k] = re.sub(r"^\w+", lambda m: m.group()[:-1] + rng.choice("aeiou_"), lines[k])
        case 6:
            lines[k] = re.sub(r'"[^"]*"', f'"{rng.choice(NAMES)}"', lines[k], count=1)
        case 7:
            lines[k] = lines[k].replace("left", "LEFT").replace("right", "left").replace("LEFT", "right")
    return "\n".join(lines) + "\n"


def mutated_model(text: str, rng: random.Random) -> str:
    """A model with an element dropped or doubled, cut short, or with an attribute dropped or changed."""
    elements = list(re.finditer(r"<\w[^>]*>", text))
    element = rng.choice(elements)
    attributes = list(re.finditer(r'\s(\w+)="([^"]*)"', element.group()))
    start, end = element.span()
    kind = rng.randrange(6)
    if kind == 0 and element.group().endswith("/>"):
        return text[:start] + text[end:]
    if kind == 1 and element.group().endswith("/>"):
        return text[:end] + element.group() + text[end:]
    if kind == 2 and rng.random() < 0.2:
        return text[:start]
    if not attributes:
        return text
    attribute = rng.choice(attributes)
    first, last = start + attribute.start(2), start + attribute.end(2)
    if kind == 3:
        return text[: start + attribute.start()] + text[start + attribute.end() :]
    numbers = attribute.group(2).split()
    if kind == 4 and numbers:
        numbers[rng.randrange(len(numbers))] = rng.choice(NUMBERS)
        return text[:first] + " ".join(numbers) + text[last:]
    return text[:first] + rng.choice((*NAMES, *NUMBERS)) + text[last:]


def load_mutant(folder: Path, number: int) -> str:
    """Load what comes of a number; returns how it was refused, nothing if it is a robot."""
    rng = random.Random(number)
    if rng.random() < 0.3:
        path = urdf_robot.write(folder)
        model = folder / "robot.urdf"
    else:
        for name in ("hrp2.xml", "hrp2.toml"):
            (folder / name).write_text(hrp2.file_texts()[name])
        path, model = folder / "hrp2.toml", folder / "hrp2.xml"
    change, target = (mutated_file, path) if rng.random() < 0.5 else (mutated_model, model)
    text = target.read_text()
    for _ in range(rng.choice((1, 1, 2))):
        text = change(text, rng)
    target.write_text(text)
    try:
        robot = Robot.load(path)
    except InputError as error:
        return str(error)
    assert robot.na > 0 and robot.mass > 0.0
    return ""


def check(folder: Path, numbers: range) -> None:
    outcomes = []
    for number in numbers:
        place = folder / str(number)
        place.mkdir()
        try:
            outcomes.append(load_mutant(place, number))
        except Exception as error:
            raise AssertionError(f"mutant {number} in {place}") from error
        assert "\n" not in outcomes[-1], f"mutant {number}: {outcomes[-1]}"
    assert 0.2 * len(outcomes) < sum(map(bool, outcomes)) < 0.9 * len(outcomes)


def test_some_mutants_are_robots_or_refused(tmp_path):
    check(tmp_path, range(QUICK))


@pytest.mark.slow
def test_many_mutants_are_robots_or_refused(tmp_path):
    check(tmp_path, range(QUICK, QUICK + THOROUGH))
