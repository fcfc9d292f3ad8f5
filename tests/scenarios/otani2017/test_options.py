"""What the command line may say about things: one line and exit 2 where it makes no sense."""

import pytest

from scenarios import cli


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["otani"], "say what is handled, box or door or bag or carry or cart, not ''"),
        (["otani", "lift"], "say what is handled, box or door or bag or carry or cart, not 'lift'"),
        (["otani", "bag", "--stiffness", "10"], "otani bag takes no --stiffness"),
        (["otani", "carry", "--from-plate"], "otani carry takes no --from-plate"),
        (["otani", "cart", "--mass", "2"], "otani cart takes no --mass"),
        (["otani", "box", "--stiffness", "10"], "otani box takes no --stiffness"),
        (["otani", "door", "--mass", "3"], "otani door takes no --mass"),
        (["otani", "box", "--mass", "-1"], "--mass -1: give a number"),
        (["otani", "box", "--friction", "2"], "friction = 2"),
        (["otani", "box", "--events", "none.toml"], "none.toml: cannot be read"),
        (["sliding", "--mass", "3"], "sliding takes no --mass"),
        (["sliding", "box"], "sliding takes no box"),
        (["otani", "box", "--clip", "groove"], "motions of its own"),
    ],
)
def test_what_makes_no_sense_is_one_line_and_leaves_nothing(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["run", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[[event]]\ntime = 1\nchange = "break"\nbetween = ["robot/left_hand", "box/left"]', "never made"),
        ('[[event]]\ntime = 1\nchange = "make"\nbetween = ["robot/left_hand", "box/lid"]', "no surface 'box/lid'"),
    ],
)
def test_an_event_file_that_makes_no_sense_is_told(text, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "events.toml").write_text(text)
    assert cli.main(["run", "otani", "box", "--events", "events.toml"]) == 2
    assert message in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["events.toml"]
