"""Text files as people's programs write them: any line ends, UTF-8, UTF-16 or UTF-32, Shift-JIS, Windows' Western."""

import codecs
from pathlib import Path

from sot.errors import InputError
from sot.git_lfs import refuse_pointer

BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, with whose mark it begins
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
MARKLESS = ("utf-16-le", "utf-16-be")
ASCII_SHARE = 0.5  # of a markless UTF-16 file's characters, at least: its other bytes are all zeros
JAPANESE = (("\u3000", "\u30ff"), ("\u4e00", "\u9fff"), ("\uff01", "\uff9f"))  # punctuation and kana, kanji, widths


def read_text(path: Path) -> str:
    """The text of a file, its lines ended by line feeds, whatever ends them in the file.

    A byte-order mark decides on the encoding. Without one it is UTF-8, or else UTF-16 where half of the bytes are
    zeros, Shift-JIS where that gives Japanese, or Windows' Western (1252), which gives something for every byte.

    Raises:
        InputError: the file cannot be read, is no text, a pointer to it, or not in the encoding that its mark promises.
    """
    refuse_pointer(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    return decoded(data, str(path)).replace("\r\n", "\n").replace("\r", "\n")


def decoded(data: bytes, where: str) -> str:
    """The text that bytes stand for; where: the file, for messages.

    Raises:
        InputError: as `read_text`.
    """
    for mark, encoding in BYTE_ORDER_MARKS:
        if data.startswith(mark):
            try:
                return data[len(mark) :].decode(encoding)
            except UnicodeDecodeError as error:
                raise InputError(
                    f"{where}: begins with the mark of {encoding.upper()} but is not in it (byte"
                    f" {len(mark) + error.start}); save it as UTF-8"
                ) from None
    if b"\0" in data:
        return _decoded_utf16(data, where)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        pass
    try:
        text = data.decode("cp932")
    except UnicodeDecodeError:
        text = ""
    other = [letter for letter in text if not letter.isascii()]
    if other and all(any(first <= letter <= last for first, last in JAPANESE) for letter in other):
        return text
    return data.decode("cp1252", errors="replace")


def _decoded_utf16(data: bytes, where: str) -> str:
    """UTF-16 without a mark, told by the zeros in every other byte."""
    for encoding, high in zip(MARKLESS, (data[1::2], data[::2]), strict=True):
        if len(data) % 2 == 0 and high.count(0) >= ASCII_SHARE * len(high):
            try:
                text = data.decode(encoding)
            except UnicodeDecodeError:
                continue
            if all(letter >= " " or letter.isspace() for letter in text):
                return text
    raise InputError(f"{where}: a binary file, or text in an unknown encoding; save it as UTF-8")
