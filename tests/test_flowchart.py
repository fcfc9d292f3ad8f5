"""The site's flowcharts: what is drawn of Mermaid's text, and what is refused."""

import re
import runpy

import pytest

from tests.pages import PAGES, ROOT, blocks

CHARTS = [chart for page in PAGES for chart in blocks(page, "mermaid")]
DRAWN = runpy.run_path(str(ROOT / "docs" / "extensions" / "flowchart.py"))
SMALL = """flowchart BT
    top["<b>top</b>"]
    middle["middle"]
    low["low & wide"]
    middle --> top
    low --> middle
    low --> top
"""


def test_arrows_point_upwards_and_long_ones_bend():
    boxes, edges = DRAWN["parse"](SMALL)
    assert DRAWN["rows_of"](list(boxes), edges) == {"top": 0, "middle": 1, "low": 2}
    layout = DRAWN["Layout"](boxes, edges)
    assert [len(path) for path in layout.paths] == [2, 2, 3]
    spans = sorted((layout.x[name] - layout.width[name] / 2, layout.width[name]) for name in layout.rows[1])
    assert spans[0][0] + spans[0][1] < spans[1][0]  # side by side


def test_text_is_escaped():
    assert "low &amp; wide" in DRAWN["drawing"](SMALL)


@pytest.mark.parametrize("chart", CHARTS, ids=range(len(CHARTS)))
def test_charts_of_the_pages_are_drawn(chart):
    drawing = DRAWN["drawing"](chart)
    assert drawing.count("<rect") == len(re.findall(r'\["', chart))
    assert drawing.count('class="arrow"') == chart.count("-->")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("flowchart LR\na --> b", "flowchart BT"),
        ('flowchart BT\na["a"]\na --> b', "no node is called b"),
        ('flowchart BT\na["a"]\na -.-> a', "neither a node nor an edge"),
        ('flowchart BT\na["a"]\nb["b"]\na --> b\nb --> a', "circle"),
    ],
)
def test_what_cannot_be_drawn_is_refused(text, said):
    with pytest.raises(ValueError, match=said):
        DRAWN["drawing"](text)
