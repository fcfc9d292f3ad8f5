"""The small clips of ../shared that went wrong once: an extra check, where they are."""

from pathlib import Path

import pytest

from sot.motion import read, recognise

CASES = Path(__file__).parents[2] / "../shared/cases"
MAPPING = CASES / "b16c_bom.toml"

pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="needs ../shared/cases")


@pytest.mark.parametrize(
    ("name", "mapping", "words"),
    [
        ("b00_base", None, None),
        ("b10c_xup", None, None),
        ("b15_chair", None, "The dancer sits from 0.00 to 1.97 s"),
        ("b15_lie", None, "The dancer lies from 0.00 to 1.97 s"),
        ("b15_oneleg", None, "The dancer stands on the left leg from 0.00 to 1.97 s"),
        ("b16_kanji", MAPPING, None),
        ("b16b_kanji_sjis", MAPPING, None),
        ("b22_spike", None, "The tracker jumps by 3.00 m at 1.00 s"),
        ("b23c_drift_up", None, "The recorded floor drifts up by 20 cm"),
    ],
)
def test_a_clip_that_went_wrong_is_a_human_now(name: str, mapping: Path | None, words: str | None) -> None:
    human = recognise(read(CASES / f"{name}.bvh"), mapping)
    assert [remark.words.startswith(words or "-") for remark in human.remarks] == ([True] if words else [])
    assert human.segment_direction("trunk")[:, 2].min() > 0.9
