"""What a guess says of itself: what was found, what it is founded on, and how sure it is."""

from dataclasses import dataclass
from enum import StrEnum


class Sureness(StrEnum):
    """How far a guess can be trusted."""

    SURE = "sure"
    LIKELY = "likely"
    UNSURE = "unsure"


@dataclass(frozen=True)
class Evidence:
    """One guess.

    Attributes:
        what: the part of the robot file, such as "feet".
        found: what was guessed, in words.
        why: what it is founded on.
        sureness: how far it can be trusted.
    """

    what: str
    found: str
    why: str
    sureness: Sureness
