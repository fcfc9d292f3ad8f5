"""The page of a library."""

import pytest

from scenarios import cli
from scenarios.library.batch import OPTIONS_FILE
from scenarios.library.job import CRASHED, FELL, UPRIGHT, Job, empty_row, write_row
from scenarios.library.page import distributions, worst_rows
from scenarios.replay import RECORDING_FILE, Replay


@pytest.fixture
def library(tmp_path):
    folder = tmp_path / "dances"
    rows = []
    for k, (name, outcome) in enumerate((("a", UPRIGHT), ("b <i>", FELL), ("c", CRASHED), ("d", UPRIGHT))):
        job = Job(name, Replay(name), folder)
        job.folder.mkdir(parents=True)
        figures = {"tracking.mpjpe_mm": 5.0 * k, "likeness.segment_deg": None} if outcome != CRASHED else {}
        rows.append(empty_row(job) | {"outcome": outcome, "seconds": 2.0, "figures": figures})
        rows[-1]["remarks"] = [f"The dancer leaps {k} times."]
        rows[-1]["times"] = {"total_s": 36.0, "plan_s": 4.0, "dance_s": 8.0}
        write_row(rows[-1], job.folder)
        (job.folder / RECORDING_FILE).write_text("")
    (folder / OPTIONS_FILE).write_text("{}")
    return folder, rows


def test_the_worst_come_first(library):
    assert [row["clip"] for row in worst_rows(library[1])] == ["c", "b <i>", "d", "a"]


def test_distributions_of_what_was_measured(library):
    shown = distributions(library[1])
    assert [one.words for one in shown] == ["key bodies off their reference, mean"]
    assert shown[0].quantiles[0] == "0" and shown[0].quantiles[-1] == "15" and max(shown[0].bars) == 60.0


@pytest.mark.parametrize("values", [(0.3, 0.1 + 0.2), (0.0, 5e-324), (7.0, 7.0)])
def test_clips_that_agree_but_for_rounding_have_a_distribution(values):
    (shown,) = distributions([{"figures": {"tracking.mpjpe_mm": value}} for value in values])
    assert sum(shown.bars) > 0.0


def test_the_page_tells_and_links(library, capsys):
    folder, _ = library
    assert cli.main(["report", str(folder)]) == cli.DONE
    page = (folder / "report.html").read_text("utf-8")
    assert "4 clips" in page and "50.0 %" in page and "The dancer leaps … times." in page
    assert "100 clips and 200 s of motion an hour a core, planned 1800 s of motion an hour, danced 900" in page
    assert 'href="clips/a/run.rrd"' in page and 'href="clips/b%20%3Ci%3E/run.rrd"' in page
    assert "<i>" not in page and "b &lt;i&gt;" in page


def test_a_library_without_clips(tmp_path, capsys):
    (tmp_path / OPTIONS_FILE).write_text("{}")
    assert cli.main(["report", str(tmp_path)]) == cli.BAD_INPUT
    assert "none of its clips" in capsys.readouterr().err
