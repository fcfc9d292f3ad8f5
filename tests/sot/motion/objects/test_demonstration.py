"""The file of a demonstration's objects."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.motion.objects.demonstration import (
    HandledObjects,
    LevelSurface,
    ObjectPath,
    read_objects,
    write_objects,
)

ROW = "[0, 0, 1, 0, 0, 0, 1]"
GOOD = f"rate = 30\n[object.box]\nsize = [1, 1, 1]\npath = [{ROW}]\n"


def test_a_file_gives_back_what_was_written(tmp_path):
    turn = Rotation.from_euler("ZX", [[0.1 * k, 0.2] for k in range(4)])
    path = ObjectPath(np.array([0.2, 0.3, 0.4]), np.arange(12.0).reshape(4, 3), turn.as_matrix(), hinged=True)
    table = LevelSurface(np.array([1.0, 0.0, 0.7]), np.array([0.5, 0.8]))
    write_objects(tmp_path / "a.toml", HandledObjects(30.0, {"box": path}, {"table": table}))
    again = read_objects(tmp_path / "a.toml")
    assert again.rate == 30.0 and again.objects["box"].hinged
    assert np.allclose(again.objects["box"].position, path.position)
    assert np.allclose(again.objects["box"].rotation, path.rotation, atol=1e-3)
    assert np.allclose(again.surfaces["table"].size, table.size)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD.replace("rate = 30", "rate = -1"), "rate must be"),
        (GOOD.replace("[1, 1, 1]", "[1, 1]"), "size must be numbers, 3"),
        (GOOD.replace("[1, 1, 1]", "[1, 1, 0]"), "sizes must be positive"),
        (GOOD.replace(ROW, "[0, 0, 1, 0, 0, 0, 3]"), "quaternions of length 1"),
        (GOOD.replace(ROW, "[0, 0, 1]"), "path must be numbers, N x 7"),
        (GOOD.replace(ROW, '"far"'), "path must be numbers"),
        (GOOD + f"[object.bag]\nsize = [1, 1, 1]\npath = [{ROW}, {ROW}]\n", "differ in length"),
        (GOOD + "[level.table]\ncentre = [1, 1, 1]\n", "level table: size"),
        (GOOD + 'hinged = "yes"\n', "hinged must be true or false"),
        ("rate = 30\n", "needs a rate"),
    ],
)
def test_a_bad_file_is_told_in_one_line(tmp_path, text, message):
    file = tmp_path / "objects.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=message):
        read_objects(file)
