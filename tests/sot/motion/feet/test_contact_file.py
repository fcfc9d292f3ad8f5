import pytest

from sot.errors import InputError
from sot.motion.feet import contact_file
from sot.motion.feet.footwork import Step

STEP = '[[step]]\nfoot = "left"\nlift = 1.0\nland = 1.5\n'


def test_what_is_written_is_read(tmp_path):
    path = tmp_path / "contacts.toml"
    steps = (Step("left_foot", 1.0, 1.52), Step("right_foot", 2.0, 2.4))
    contact_file.write(path, steps)
    assert contact_file.read(path) == steps
    assert [file.name for file in tmp_path.iterdir()] == ["contacts.toml"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("lift =", "not a TOML file"),
        ("[[hop]]\n", "something else"),
        ("step = 3", "something else"),
        (STEP + "height = 2", "step 1 needs foot, lift and land"),
        (STEP.replace("left", "middle"), "choose left or right"),
        (STEP.replace("1.5", '"late"'), "must be times"),
        (STEP.replace("1.5", "0.5"), "after it is lifted"),
        (STEP.replace("1.5", "nan"), "after it is lifted"),
        (STEP + STEP.replace("1.0", "1.2"), "before it lands"),
    ],
)
def test_errors_are_one_clear_line(tmp_path, text, words):
    path = tmp_path / "contacts.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=words) as error:
        contact_file.read(path)
    assert "\n" not in str(error.value) and str(path) in str(error.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        contact_file.read(tmp_path / "none.toml")
