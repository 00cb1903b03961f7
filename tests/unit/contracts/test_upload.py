"""What a file must be to be accepted at all."""

import pytest

from grader.contracts.errors import RefusedError
from grader.contracts.upload import check_name, check_source, decoded, in_utf8


@pytest.mark.parametrize(
    ("head", "accepted"),
    [
        ("# -*- coding: gbk -*-\n", True),
        ("\n# vim: set fileencoding=GB18030 :\n", True),
        ("# -*- coding: utf8 -*-\n", False),
        ("# -*- coding: rot13 -*-\n", False),
        ("# coding: UTF-8\n# coding: gbk\n", False),
        ("import math\n# coding: gbk\n", False),
        ("#\n#\n# coding: gbk\n", False),
    ],
)
def test_a_chinese_coding_is_taken_where_python_would_heed_its_declaration(head: str, accepted: bool) -> None:
    source = (head + "s = '方'\n").encode("gbk")
    if accepted:
        check_source(source)
        assert "方" in decoded(source)
        return
    with pytest.raises(RefusedError, match="GBK") as refused:
        check_source(source)
    assert refused.value.code == "not_utf8"
    assert "VS Code" in refused.value.zh
    assert "Notepad" in str(refused.value)
    assert "记事本" in refused.value.zh


def test_what_is_no_gbk_either_is_not_called_that() -> None:
    with pytest.raises(RefusedError, match="not UTF-8") as refused:
        check_source(b"s = '\xff\xff'\n")
    assert "seems" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("square_mover.py.txt", "square_mover.py "),
        ("square_mover.pyw", "square_mover.py "),
        ("square_mover.TXT", "square_mover.py "),
        ("square_mover。py", "square_mover.py "),
        ("square.ipynb", "notebook"),
        ("square", "end in .py"),
    ],
)
def test_a_name_that_is_not_a_scripts_is_refused_with_the_remedy(name: str, remedy: str) -> None:
    with pytest.raises(RefusedError) as refused:
        check_name(name, (".py",))
    assert refused.value.code == "wrong_file_type"
    assert remedy in str(refused.value)
    check_name("square_mover.py", (".py",))


def test_a_notebook_under_another_name_is_told_so() -> None:
    notebook = b'{"cells": [{"cell_type": "code", "source": []}], "nbformat": 4}'
    with pytest.raises(RefusedError, match="notebook") as refused:
        check_source(notebook)
    assert refused.value.code == "wrong_file_type"
    check_source(b"{'cells': 3}\n")


def test_what_is_utf_8_is_accepted_whatever_it_declares() -> None:
    check_source("# coding: gbk\ns = '方'\n".encode())
    check_source(b"\xef\xbb\xbf" + "s = '方'\n".encode())


@pytest.mark.parametrize(
    ("content", "code", "said"),
    [
        ("print('方')\n".encode("utf-16"), "not_utf8", "UTF-16"),
        ("print('方')\n".encode("utf-16-be"), "contains_nul", "NUL"),
        (b"PK\x03\x04\x14\0\0", "contains_nul", "Word"),
        (b"%PDF-1.7 all printable", "contains_nul", "PDF"),
        (b"print(1)\n\0", "contains_nul", "2"),
    ],
)
def test_what_is_no_text_is_named(content: bytes, code: str, said: str) -> None:
    with pytest.raises(RefusedError) as refused:
        check_source(content)
    assert refused.value.code == code
    assert said in str(refused.value)
    assert said in refused.value.zh


@pytest.mark.parametrize("coding", ["utf-8", "utf-8-sig", "gbk", "utf-16"])
def test_a_text_may_be_in_what_notepad_saves(coding: str) -> None:
    text = "定时器每 0.1 秒调用一次回调。"
    assert in_utf8(text.encode(coding)).decode("utf-8-sig") == text


@pytest.mark.parametrize("other", [b"PK\x03\x04\x14", b"\xff", b"\x89PNG\r\n"])
def test_what_is_no_text_stays_what_it_is(other: bytes) -> None:
    assert in_utf8(other) == other
