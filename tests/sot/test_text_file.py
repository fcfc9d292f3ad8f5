"""Text in the encodings and with the line ends that people's programs write."""

import codecs
from pathlib import Path

import numpy as np
import pytest

from scenarios.inputs import edit_file
from scenarios.inputs.stack_file import load_module
from sot.errors import InputError
from sot.motion import read, recognise
from sot.motion.feet import contact_file
from sot.motion.human.formats.bvh import read_bvh
from sot.text_file import read_text
from sot.toml_file import read_toml
from tests.sot.motion.human.clips import short_groove

ENCODINGS = ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp932"]
LINE_ENDS = ["\n", "\r\n", "\r"]
JAPANESE = {"Head": "頭", "LeftArm": "左腕", "LeftForeArm": "左ひじ", "LeftHand": "左手首", "Hips": "センター"}


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("end", LINE_ENDS, ids=["LF", "CRLF", "CR"])
def test_text_is_read_whatever_its_encoding_and_line_ends(tmp_path: Path, encoding: str, end: str) -> None:
    path = tmp_path / "text"
    path.write_bytes(end.join(["HIERARCHY", "ROOT センター", "  頭 = 1", ""]).encode(encoding))
    assert read_text(path) == "HIERARCHY\nROOT センター\n  頭 = 1\n"


def test_western_letters_of_windows_are_read(tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes("Käthes Hüfte, Gelé déjà".encode("cp1252"))
    assert read_text(path) == "Käthes Hüfte, Gelé déjà"


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"\x00\x01\x02\x00\xff" * 9, "save it as UTF-8"),
        (codecs.BOM_UTF8 + b"caf\xe9", r"mark of UTF-8 but is not in it \(byte 6\)"),
        (codecs.BOM_UTF16_LE + b"a\0b", "mark of UTF-16-LE"),
    ],
)
def test_what_is_no_text_is_told_in_one_line(tmp_path: Path, data: bytes, words: str) -> None:
    path = tmp_path / "clip.bvh"
    path.write_bytes(data)
    with pytest.raises(InputError, match=rf"clip.bvh: .*{words}") as error:
        read(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_clip_and_its_mapping_are_read(tmp_path: Path, encoding: str) -> None:
    text = short_groove()
    plain = tmp_path / "plain.bvh"
    plain.write_text(text, encoding="ascii")
    for name, other in JAPANESE.items():
        text = text.replace(f" {name}\n", f" {other}\n")
    clip, mapping = tmp_path / "clip.bvh", tmp_path / "names.toml"
    clip.write_bytes(text.replace("\n", "\r\n").encode(encoding))
    names = {
        "head": "頭",
        **{
            f"{side.lower()}_{joint}": JAPANESE.get(side + part, side + part)
            for side in ("Left", "Right")
            for joint, part in [
                ("shoulder", "Arm"),
                ("elbow", "ForeArm"),
                ("wrist", "Hand"),
                ("hip", "UpLeg"),
                ("knee", "Leg"),
                ("ankle", "Foot"),
            ]
        },
    }
    mapping.write_bytes("\r".join(f'{joint} = "{name}"' for joint, name in names.items()).encode(encoding))
    assert read_bvh(clip).joints[0] == "センター"
    human, expected = recognise(read(clip), mapping), recognise(read(plain))
    np.testing.assert_array_equal(human.points["left_wrist"], expected.points["left_wrist"])


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_small_files_of_the_user_are_read(tmp_path: Path, encoding: str) -> None:
    steps, edits, script = tmp_path / "steps.toml", tmp_path / "edits.toml", tmp_path / "own.py"
    steps.write_bytes('# 左足\r[[step]]\rfoot = "left"\rlift = 1.0\rland = 1.5\r'.encode(encoding))
    edits.write_bytes(
        '# 左手\r\n[[edit]]\r\npoint = "left_hand"\r\naxis = "z"\r\nby = 0.1\r\nfrom = 1\r\nto = 2\r\n'.encode(encoding)
    )
    script.write_bytes('NAME = "左手"\r\nfor k in range(3):\r\n    LAST = k\r\n'.encode(encoding))
    assert contact_file.read(steps)[0].lift == 1.0
    assert edit_file.read_edits(edits)[0].of == "left_hand"
    module = load_module(script)
    assert (module.NAME, module.LAST) == ("左手", 2)


def test_a_toml_file_that_is_missing_or_none_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none.toml: cannot be read: No such file .*; give a robot file \(.toml\)"):
        read_toml(tmp_path / "none.toml", "a robot file")
    path = tmp_path / "bad.toml"
    path.write_text("a = \n")
    with pytest.raises(InputError, match=r"bad.toml: not a TOML file"):
        read_toml(path, "a robot file")
