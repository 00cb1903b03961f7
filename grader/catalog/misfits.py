"""What does not fit in an ``assignment.yaml``, in words: the schema's own rules and pydantic's."""

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final, get_args

import yaml
from pydantic import BaseModel

from grader.contracts.assignment import BY_PERSON
from grader.contracts.errors import AssignmentError
from grader.contracts.text import LANGUAGES, Text
from grader.contracts.validation_words import said

ID_PATTERN: Final = r"^[a-z][a-z0-9_]{0,39}$"
ANY_TYPE_PATTERN: Final = r"^[a-z][a-z0-9_]*/(msg|srv|action)/[A-Z][A-Za-z0-9]*$"
WRONG_FILE_PATTERN: Final = r"^[a-z][a-z0-9_]*\.(py|txt|md|zip)$"
ABOUT_PATTERN: Final = r"""^[^\\"']*$"""

_NUMBER: Final = Text(zh="要写一个数，不带单位和引号", en="write a number, without a unit or quotes")
_WHOLE: Final = Text(zh="要写一个整数，不带单位和引号", en="write a whole number, without a unit or quotes")
_LIST: Final = Text(zh="要写成列表：[…, …]", en="write a list: […, …]")
_FIXES: Mapping[str, Text] = {
    "missing": Text(zh="缺少这个字段：请加上", en="this field is required; add it"),
    "too_short": Text(zh="至少要有一项", en="give at least one entry"),
    "float_parsing": _NUMBER,
    "float_type": _NUMBER,
    "int_parsing": _WHOLE,
    "int_type": _WHOLE,
    "int_from_float": _WHOLE,
    "list_type": _LIST,
    "tuple_type": _LIST,
    "dict_type": Text(zh="这里要写字段，例如 {sides: 4}", en="write fields here, such as {sides: 4}"),
    "string_type": Text(
        zh="要写文字：数字、on、off、yes、no 要加引号；这里没有 {zh: …, en: …}",
        en="write a text: put quotes around a number, on, off, yes and no; it is no {zh: …, en: …}",
    ),
}
_TOO_FEW: Final = Text(zh="列表太短：这里还要一个值", en="the list is too short; add a value here")
_FORMS: Mapping[str, Text] = {
    ID_PATTERN: Text(
        zh="用小写英文字母、数字和 _，以字母开头，最多 40 个字符",
        en="use small letters, digits and _, beginning with a letter, at most 40 characters",
    ),
    WRONG_FILE_PATTERN: Text(
        zh="文件名用小写英文字母、数字和 _，以 .py、.txt、.md 或 .zip 结尾",
        en="use small letters, digits and _, ending in .py, .txt, .md or .zip",
    ),
    ABOUT_PATTERN: Text(
        zh="写一句话，不用引号和反斜杠", en="write a sentence without quotes and backslashes"
    ),
    ANY_TYPE_PATTERN: Text(
        zh="写成 geometry_msgs/msg/Twist 这样的类型",
        en="write a type such as geometry_msgs/msg/Twist",
    ),
}
_OTHER_FORM: Final = Text(
    zh="写成 /turtle1/cmd_vel 这样的名字，以 / 开头",
    en="write a name such as /turtle1/cmd_vel, beginning with /",
)
_NOT_YAML: Final = Text(
    zh="YAML 格式不对（{problem}）。检查这一行和上一行：缩进只用空格、同一层对齐；符号用英文的，冒号后空一格；"
    "文字里有冒号、或以 * & ! @ % 开头时，整段加引号",
    en="not valid YAML: {problem}. Look at this line and the one before: indent by spaces, alike on one level; "
    "half-width : and , with a space behind each; quotes around a text that has a colon or begins with * & ! @ %",
)

NO_BAND = Text(
    zh=f"{BY_PERSON!r} 由人评分：删掉 low、high、ramp、limit 和 hint",
    en=f"a person judges {BY_PERSON!r}: remove low, high, ramp, limit and hint",
)
BAND_MISSING = Text(
    zh=f"写上 low、high 或两个都写：满分的范围（由人评分的写 measure: {BY_PERSON}）",
    en=f"give low, high or both: the band of full credit (what a person judges has measure: {BY_PERSON})",
)
CENTS = Text(
    zh="最多两位小数：分数按 0.01 分计", en="use at most two decimals: points are counted in hundredths"
)
SCORE = Text(
    zh="写成 [最低分, 最高分]，0 <= 最低分 <= 最高分",
    en="must be [low, high] with 0 <= low <= high; correct it",
)

NO_REFERENCE = Text(
    zh="只有 input: script 才能写 reference: solution：改写 pieces",
    en="only `input: script` can have `reference: solution`; give pieces instead",
)
ONE_PIECE = Text(
    zh="一段路写成 {line: 2.0}、{arc: 360, radius: 1.0}、{turn: 90}、{goto: [1.0, 2.0]} 之一，不能是 0",
    en="write a piece as one of {line: 2.0}, {arc: 360, radius: 1.0}, {turn: 90}, {goto: [1.0, 2.0]}; not zero",
)
ARC = Text(
    zh="arc 和 radius 要一起写：{arc: 360, radius: 1.0}",
    en="arc and radius belong together; write {arc: 360, radius: 1.0}",
)


_QUOTES = Text(
    zh="未知的字段；如果它是文字的一部分，给整段文字加上引号",
    en="unknown field; if it is part of a text, put quotes around the whole text",
)
ONE_STEP = Text(
    zh="publish、call、goal、set、get、serve 只写一个",
    en="give one of publish, call, goal, set, get, serve",
)
STEP_NEEDS_TYPE = Text(
    zh="publish、call、goal、serve 要写 type；set、get 不写",
    en="publish, call, goal and serve have a type; set and get have none",
)
ONE_EXPECTATION = Text(
    zh="每一条写期望什么，写一个：topic、answer、goal、set、parameter、frame、log、node、listener、service、"
    "client、action、served、turtle",
    en="say what is expected: one of topic, answer, goal, set, parameter, frame, log, node, listener, service, "
    "client, action, served, turtle",
)
PARAMETER_SOURCE = Text(
    zh="写 of（一步 get 的 id），或者写 node（节点名，只看 type 和 value）",
    en="give of (the id of a get step), or node (its name; then only type and value can be looked at)",
)
NO_COUNT = Text(
    zh="写成一个整数 3（正好）、[2, 4]（2 到 4）或 [2, null]（至少 2）；这里不能写公式",
    en="write a whole number such as 3 (exactly), [2, 4], or [2, null] (two at least); no formula can stand here",
)
NO_MOTION = Text(
    zh="缺少：写 ahead_m（向前多少米）、turned_deg（左转多少度）或两者都写",
    en="missing; write ahead_m, turned_deg (to the left), or both",
)
MEASURE_OR_EXPECT = Text(
    zh="写 measure（和 low、high），或者写 expect，只写一种",
    en="give a measure (with low, high), or expect; one of the two",
)
SAME_TYPE = Text(
    zh="前面的一条给同一个话题写了另一种 type：改成一样的",
    en="an earlier one gives this topic another type; give it the same",
)
TOO_MANY_SENT = Text(
    zh="所有 steps 加起来最多发 1000 次：减小 count",
    en="the steps send more than 1000 messages, calls and goals in all; make count smaller",
)


def bad_formula(why: str) -> Text:
    """Say that a formula cannot be read."""
    return Text(zh=f"公式看不懂：{why}", en=f"this formula is not understood: {why}")


def unknown_name(name: str, known: Iterable[str]) -> Text:
    """Say that a formula asks for what it is not given."""
    names = ", ".join(known)
    return Text(
        zh=f"公式里没有 {name!r}；有：{names}，以及 turtle1 等小乌龟",
        en=f"a formula knows no {name!r} here; there are {names}, and turtles such as turtle1",
    )


def not_of_step(kind: str, known: Iterable[str]) -> Text:
    """Say that a step of this kind has no such field."""
    names = ", ".join(("id", "at_s", *known))
    return Text(
        zh=f"{kind} 没有这个字段：删掉；可以写 {names}",
        en=f"a step of {kind} has no such field; remove it; there are {names}",
    )


def unknown_step(name: str, kind: str | None, known: Iterable[str]) -> Text:
    """Say that there is no step with this id, or that it is of another kind."""
    names, of_kind = ", ".join(known) or "—", f" {kind}" if kind else ""
    return Text(
        zh=f"没有 id 是 {name!r} 的{of_kind} 步骤；有：{names}",
        en=f"there is no{of_kind} step with the id {name!r}; there are: {names}",
    )


ONE_PATH = Text(
    zh="写 pieces（每段路），或 reference: solution（答案走的路），只写一个",
    en="give pieces, or reference: solution (what the solution drives); one of the two",
)
NOT_ACROSS = Text(
    zh="worst 和 mean 要有两个以上的 cases，而且由程序评分：删掉 across，或加上 cases",
    en="worst and mean need two cases or more, and a measure of the grader's; remove across or add cases",
)
ONE_REGION = Text(
    zh="一个地方写成 {at: [x, y], within: 0.2} 或 {box: [左, 下, 右, 上]}，单位 m；左 < 右，下 < 上",
    en="write a place as {at: [x, y], within: 0.2} or {box: [left, bottom, right, top]}, in m; "
    "left is less than right, bottom less than top",
)
NO_FREE_PLACE = Text(
    zh="在这个范围里找不到离目标和禁区足够远的出发点：放宽范围，或把目标变小",
    en="no start within these bounds is 0.5 m away from all that is to be visited or avoided; widen the bounds",
)
TOO_SMALL = Text(zh="不能小于 0", en="Use 0 or more")
TOO_LARGE = Text(zh="不能大于 11", en="Use 11 or less")
NO_ROOM = Text(
    zh="机器人需要房间：写 room: {bounds: [左, 下, 右, 上]}，单位 m",
    en="a robot needs a room; write room: {bounds: [left, bottom, right, top]}, in m",
)
NO_WATCH = Text(
    zh="PyBullet 的世界要写看什么：watch: {object: sphere2.urdf}",
    en="a PyBullet world needs what to look at; write watch: {object: sphere2.urdf}",
)
NO_PYBULLET = Text(
    zh="只有 PyBullet 的世界才有：写 kind: pybullet，或删掉它",
    en="only a PyBullet world has it; write kind: pybullet or remove it",
)
NO_ROBOT = Text(
    zh="只有机器人才有：写 kind: robot，或删掉它", en="only a robot has it; write kind: robot or remove it"
)
NOT_OF_ROBOTS = Text(
    zh="机器人没有这个字段（墙写在 room 里，里程计总是有）：删掉它",
    en="a robot does not take it: its walls stand in room, and it always has odometry; remove it",
)
BOUNDS = Text(
    zh="写成 [左, 下, 右, 上]，左 < 右，下 < 上，每边 0.5 到 20 m",
    en="write [left, bottom, right, top] with left < right and bottom < top, 0.5 to 20 m wide and high",
)
SAME_ENDS = Text(zh="两端重合：移开一端", en="both ends are the same; move one")
NO_FREE_ROOM = Text(
    zh="200 次里没有一次能让它离出发点、目标和其他东西足够远：移走它，或放宽范围",
    en="in 200 draws it was never far enough from the start, the goals and the rest; move it or widen its range",
)
START_OUTSIDE = Text(
    zh="机器人的出发点（world.start，不写就是 0, 0）不在房间里，或碰到墙：放大房间，或改出发点",
    en="the robot's start (world.start; 0, 0 if left out) is outside of the room or touches its wall; "
    "make the room larger or move the start",
)
NOT_READ = Text(
    zh="启动文件以 .launch.py、.launch.xml 或 .launch.yaml 结尾：写全名",
    en="a launch file ends in .launch.py, .launch.xml or .launch.yaml; write its whole name",
)
NUMBER = Text(zh="写成数字，不是 true 或 false", en="write a number, not true or false")
RANGE = Text(
    zh="写成一个数，或 [最小, 最大]，最小 <= 最大", en="write one number, or [least, most] with least <= most"
)


def swapped(low: float, high: float) -> Text:
    """Say that the ends of a band are the wrong way round."""
    return Text(
        zh=f"low（{low}）大于 high（{high}）：对调", en=f"low ({low}) is above high ({high}); swap them"
    )


def twice(name: str) -> Text:
    """Say that an earlier entry has this id."""
    return Text(zh=f"前面已经有 {name!r}：换一个名字", en=f"an earlier one is {name!r}, too; rename one")


def unknown_topic(name: str, known: Iterable[str]) -> Text:
    """Say that a robot does not publish on this topic."""
    names = ", ".join(known)
    return Text(
        zh=f"机器人没有话题 {name!r}；有：{names}", en=f"a robot has no topic {name!r}; it has: {names}"
    )


def too_late(name: str, horizon_s: float) -> Text:
    """Say that the run has ended by then."""
    return Text(
        zh=f"运行到 horizon_s（{horizon_s:g} s）就结束了：把 {name} 写早一些，或者加大 horizon_s",
        en=f"the run ends at horizon_s ({horizon_s:g} s); write an earlier {name} or a larger horizon_s",
    )


def not_before(name: str) -> Text:
    """Say that a rubric item needs itself or a later one."""
    return Text(
        zh=f"评分项 {name!r} 不在这一项前面：把它移到前面",
        en=f"the item {name!r} does not stand before this one; move it up",
    )


def unknown_item(name: str, known: Iterable[str]) -> Text:
    """Say that no rubric item has this id."""
    names = ", ".join(known)
    return Text(
        zh=f"没有 id 是 {name!r} 的评分项；有：{names}", en=f"no item has the id {name!r}; there are: {names}"
    )


def unknown_base(name: str, known: Iterable[str]) -> Text:
    """Say that no script above a wrong attempt, which is a change of one, has this name."""
    names = ", ".join(known)
    return Text(
        zh=f"前面没有脚本 {name!r}；有：{names}",
        en=f"no script above this one is {name!r}; there are: {names}",
    )


def no_other_measure(name: str) -> Text:
    """Say that no other rubric item that the grader measures has this id."""
    return Text(
        zh=f"没有另一个由程序评分、id 是 {name!r} 的评分项：检查拼写",
        en=f"{name!r} is the id of no other item that the grader measures; check its spelling",
    )


def unknown_type(name: str) -> Text:
    """Say that there is no such message, service or action, or that it is another kind of type."""
    return Text(
        zh=f"没有类型 {name!r}，或者这里要的不是这一种：检查拼写，或者在 interfaces/ 里补上它",
        en=f"there is no type {name!r}, or another kind is wanted here; check it, or add it in interfaces/",
    )


def no_such_field_of(name: str, known: Iterable[str]) -> Text:
    """Say that a message has no such field."""
    names = ", ".join(known) or "—"
    return Text(
        zh=f"这种消息没有字段 {name!r}；有：{names}", en=f"there is no field {name!r}; there are: {names}"
    )


def wrong_ending(input_: str, endings: tuple[str, ...]) -> Text:
    """Say that an assignment with this input does not take such a file."""
    return Text(
        zh=f"input 是 {input_} 时，文件名以 {' 或 '.join(endings)} 结尾",
        en=f"with input {input_} its name ends in {' or '.join(endings)}",
    )


class MisfitError(ValueError):
    """A value breaks a rule of the schema.

    Attributes:
        told: what is wrong and what to do.
        field: steps from the model that has the rule to the field it is about.
    """

    def __init__(self, told: Text, *field: int | str) -> None:
        super().__init__(told.en)
        self.told = told
        self.field = field


_BRANCH: Final = re.compile(r"(constrained-)?float|tuple\[.*\]|<\w+>|(float|str|int|none|json-\w+)")
"""How pydantic calls one of several types, where either may stand."""


def root_causes(errors: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return pydantic's `errors()` without those that only follow from others.

    If entries of a list are refused, pydantic also calls the list too short. It refuses a wrong value of a field
    that may be a number or a pair twice, once as each.
    """
    places = [error["loc"] for error in errors]

    def follows(error: Mapping[str, Any]) -> bool:
        place = error["loc"]
        if error["type"] == "too_short":
            return any(len(other) > len(place) and other[: len(place)] == place for other in places)
        return error["type"] in ("float_type", "tuple_type") and _BRANCH.fullmatch(str(place[-1])) is not None

    return [error for error in errors if not follows(error)]


def _models(annotation: object) -> Iterator[type[BaseModel]]:
    """Yield the models within an annotation such as ``tuple[ItemModel, ...]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models(part)


def _fields_at(model: type[BaseModel], place: Sequence[int | str]) -> tuple[str, ...]:
    """Return the fields that the part of the file at `place` may have; none where it is no model's."""
    models: list[type[BaseModel]] = [model]
    for step in place:
        if isinstance(step, str):  # a number leads to an entry of a list, which is of the list's model
            named = [
                one for each in models for name, one in each.model_fields.items() if step in (name, one.alias)
            ]
            models = [each for field in named for each in _models(field.annotation)]
    return tuple(
        dict.fromkeys(one.alias or name for each in models for name, one in each.model_fields.items())
    )


_FORMER_FIELDS: Final = ("calls", "agent")
_USE_STEPS: Final = Text(
    zh="现在写成 check: conversation、steps 和评分项的 expect，见 docs/exercises.zh.md",
    en="write check: conversation, steps, and expect in the items instead: see docs/exercises.md",
)


def _no_such_field(name: str, known: Sequence[str]) -> Text:
    if name in _FORMER_FIELDS and "steps" in known:
        return _USE_STEPS
    likely = [one for one in known if one.startswith(name)] or difflib.get_close_matches(name, known, 1)
    if likely:
        return Text(zh=f"没有这个字段：是不是 {likely[0]}？", en=f"unknown field; did you mean {likely[0]}?")
    names = ", ".join(known) or "—"
    return Text(
        zh=f"没有这个字段：检查拼写，或者删掉；这里可以写 {names}",
        en=f"unknown field; check its spelling or remove it; there are {names}",
    )


def _no_fields(known: Sequence[str]) -> Text:
    if known == ("zh", "en"):
        return Text(
            zh="这里要写字段，例如 {zh: 标题, en: Title}",
            en="write fields here, such as {zh: 标题, en: Title}",
        )
    names = ", ".join(known)
    return Text(zh=f"这里要写字段（{names}）", en=f"write fields here ({names})")


def misfit(error: Mapping[str, Any], model: type[BaseModel]) -> tuple[tuple[int | str, ...], Text]:
    """Return the field that one of pydantic's `errors()` is about, and what is wrong with it.

    `model` is that of the whole file.
    """
    kind, context = error["type"], error.get("ctx", {})
    place = tuple(step for step in error["loc"] if not _BRANCH.fullmatch(str(step)))
    broken = context.get("error")
    if isinstance(broken, MisfitError):
        return place + broken.field, broken.told
    if kind == "string_pattern_mismatch":
        return place, _FORMS.get(context["pattern"], _OTHER_FORM)
    if kind == "extra_forbidden" and not re.fullmatch(r"\w+", str(place[-1])):
        return place, _QUOTES  # what stands behind a comma of a text
    if kind == "extra_forbidden":
        return place, _no_such_field(str(place[-1]), _fields_at(model, place[:-1]))
    if kind == "model_type":
        return place, _no_fields(_fields_at(model, place))
    if kind == "missing" and isinstance(place[-1], int):
        return place, _TOO_FEW
    if kind in _FIXES:
        return place, _FIXES[kind]
    zh, en = (said(error, language).rstrip("。.") for language in LANGUAGES)
    return place, Text(zh=zh, en=en)


class WrongKeyError(yaml.constructor.ConstructorError):
    """A key or value that PyYAML accepts, or fails on, and that is a mistake in an assignment."""

    def __init__(self, told: Text, mark: yaml.Mark) -> None:
        super().__init__(None, None, told.en, mark)
        self.told = told


def unparsable(error: yaml.MarkedYAMLError) -> Text:
    """Return why a text is not YAML; what the parser itself says stays in English."""
    if isinstance(error, WrongKeyError):
        return error.told
    problem = error.problem or "?"
    return Text(zh=_NOT_YAML.zh.format(problem=problem), en=_NOT_YAML.en.format(problem=problem))


def refusals(found: Iterable[tuple[str, Text]]) -> AssignmentError:
    """Return the error that says what is wrong where: a line for each (file, line and field; what is wrong)."""
    lines = tuple(found)
    error = AssignmentError(
        "\n".join(f"{place}: {told.en}" for place, told in lines),
        "\n".join(f"{place}: {told.zh}" for place, told in lines),
    )
    error.problems = lines
    return error
