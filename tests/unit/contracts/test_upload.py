"""What a file must be to be accepted at all."""

import pytest

from grader.contracts.errors import RefusedError
from grader.contracts.upload import check_source


@pytest.mark.parametrize(
    ("head", "advice"),
    [
        ("# -*- coding: gbk -*-\n", "delete line 1, which declares gbk"),
        ("\n# vim: set fileencoding=GB18030 :\n", "delete line 2, which declares GB18030"),
        ("# -*- coding: utf8 -*-\n", ""),
        ("# coding: UTF-8\n# coding: gbk\n", ""),
        ("import math\n# coding: gbk\n", ""),
        ("#\n#\n# coding: gbk\n", ""),
    ],
)
def test_a_declared_coding_is_named_where_python_would_heed_it(head: str, advice: str) -> None:
    with pytest.raises(RefusedError, match="save the file as UTF-8") as refused:
        check_source((head + "s = '方'\n").encode("gbk"))
    assert refused.value.code == "not_utf8"
    assert advice in str(refused.value)
    assert ("declares" in str(refused.value)) == bool(advice)
    assert ("声明" in refused.value.zh) == bool(advice)


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
