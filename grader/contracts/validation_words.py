"""What is wrong with a field of a request: a sentence in both languages for each type of pydantic's errors."""

import re
from collections.abc import Mapping
from typing import Any, Final

from grader.contracts.notation import written
from grader.contracts.text import Language, Text

_NUMBER = Text(zh="要填一个数。", en="This is not a number.")
_INTEGER = Text(zh="要填一个整数。", en="This is not a whole number.")
_INSTANT = Text(
    zh="要填一个时间，例如 2026-03-20T23:59:59。",
    en="This is not a date and time such as 2026-03-20T23:59:59.",
)
_MEMBER = re.compile(r"<\w+\.\w+: ('[^']*')>")
_ONE_OF = Text(zh="只能是这些值之一：{expected}。", en="Use one of these: {expected}.")
_LIST = Text(zh="要填一个列表。", en="This is not a list.")
_OBJECT = Text(zh="要填一个 JSON 对象。", en="This is not a JSON object.")
_UNREADABLE = Text(zh="文字里有不能使用的字符。", en="The text has characters that are not accepted.")

OUT_OF_YEARS: Final = ("out_of_years", "Use a year from 2000 to 2200.")
NO_FILE: Final = ("no_file", "This is text, not a file. With curl write -F file=@square.py, with the @.")
SENT_TWICE: Final = ("sent_twice", "Send this field once.")
"""Type and English message of errors of our own: an instant outside of `rules.YEARS`, and parts of a form."""

_SENTENCES: Mapping[str, Text] = {
    "missing": Text(zh="缺少这个字段。", en="This field is missing."),
    "extra_forbidden": Text(zh="没有这个字段。", en="There is no such field."),
    "greater_than": Text(zh="要大于 {gt}。", en="Use more than {gt}."),
    "greater_than_equal": Text(zh="不能小于 {ge}。", en="Use {ge} or more."),
    "less_than_equal": Text(zh="不能大于 {le}。", en="Use {le} or less."),
    "string_too_short": Text(
        zh="至少 {min_length} 个字。", en="This is too short; the least is {min_length}."
    ),
    "string_too_long": Text(zh="最多 {max_length} 个字。", en="Use at most {max_length} characters."),
    "too_long": Text(zh="最多 {max_length} 项。", en="Use at most {max_length} entries."),
    "string_pattern_mismatch": _UNREADABLE,
    "string_unicode": _UNREADABLE,
    "string_type": Text(zh="要填文字。", en="This is not text."),
    "json_invalid": Text(zh="这不是 JSON。", en="This is not JSON."),
    "uuid_parsing": Text(zh="这不是提交的编号。", en="This is no submission's id."),
    "finite_number": Text(zh="要填一个有限的数。", en="This is not a finite number."),
    "float_parsing": _NUMBER,
    "float_type": _NUMBER,
    "int_parsing": _INTEGER,
    "int_parsing_size": _INTEGER,
    "int_from_float": _INTEGER,
    "int_type": _INTEGER,
    "bool_parsing": Text(zh="要填 true 或 false。", en="Use true or false."),
    "bool_type": Text(zh="要填 true 或 false。", en="Use true or false."),
    "enum": _ONE_OF,
    "literal_error": _ONE_OF,
    "union_tag_not_found": Text(zh="缺少 {discriminator}。", en="{discriminator} is missing."),
    "union_tag_invalid": Text(
        zh="{discriminator} 只能是这些值之一：{expected_tags}。",
        en="{discriminator}: use one of {expected_tags}.",
    ),
    "datetime_type": _INSTANT,
    "datetime_parsing": _INSTANT,
    "datetime_from_date_parsing": _INSTANT,
    OUT_OF_YEARS[0]: Text(zh="年份要在 2000 到 2200 之间。", en=OUT_OF_YEARS[1]),
    NO_FILE[0]: Text(zh="这是文字，不是文件。用 curl 时写 -F file=@square.py，不要漏掉 @。", en=NO_FILE[1]),
    SENT_TWICE[0]: Text(zh="这个字段只能有一个。", en=SENT_TWICE[1]),
    "list_type": _LIST,
    "tuple_type": _LIST,
    "dict_type": _OBJECT,
    "model_type": _OBJECT,
    "model_attributes_type": _OBJECT,
}


def said(problem: Mapping[str, Any], language: Language) -> str:
    """Return the sentence for one of pydantic's `errors()`; a type without one keeps pydantic's English.

    A ValueError of ours has its sentence in English and, unless that is for both, in Chinese.
    """
    own = problem.get("ctx", {}).get("error")
    if isinstance(own, ValueError):
        return str(own.args[-1 if language == "zh" else 0])
    sentence = _SENTENCES.get(problem["type"])
    if sentence is None:
        return str(problem["msg"])
    limits = problem.get("ctx", {}).items()
    shown = {name: written(value) if isinstance(value, float) else value for name, value in limits}
    if "expected" in shown:  # pydantic writes the members of an enumeration as Python does
        shown["expected"] = _MEMBER.sub(r"\1", str(shown["expected"]))
    if language == "zh" and "expected" in shown:  # pydantic joins the values in English
        shown["expected"] = str(shown["expected"]).replace(" or ", "、").replace(", ", "、")
    return sentence.get(language).format(**shown)
