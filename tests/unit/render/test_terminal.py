"""What `grader check` prints: complete, in 80 columns, with nothing of the student's text taken literally."""

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from grader.contracts.outcome import LogRecord, Note, RunOutcome, RunStatus, Stream, StudentError
from grader.contracts.report import CaseRun, GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import Language
from grader.render.terminal import console, render_report
from tests.unit.render.samples import crash, item, outcome, report, square_report, t

HOSTILE = "\x1b[2J\x1b]0;title\x07 \u202eevil\u2069 [bold red]mark[/bold red] [/] :smile: \x9b31m"


def shown(graded: GradeReport, language: Language = "zh", width: int = 80, logs: bool = False) -> str:
    stream = io.StringIO()
    renderable = render_report(
        graded, language=language, file_name="square_mover.py", title=t("正方形", "Square"), show_logs=logs
    )
    console(stream, width).print(renderable)
    return stream.getvalue()


def test_chinese_report() -> None:
    text = shown(square_report())
    for part in (
        "正方形",
        "square_mover.py",
        "得分 7.25 / 10",
        "边长相等",
        "18.4 %",
        "不超过 5 %",
        "1.25/2",
        "下一步",
    ):
        assert part in text
    assert "✗ 未过" in text
    assert "~ 部分" in text
    assert "- 未查" in text


def test_items_of_several_cases_stand_below_their_titles() -> None:
    graded = report(items=tuple(item(id=f"{case}/sides") for case in ("near", "near", "far")))
    stream = io.StringIO()
    titles = {"near": t("近", "Near start"), "far": t("远", "Far start")}
    table = render_report(graded, language="en", file_name="a.py", title=t("题", "Task"), cases=titles)
    console(stream, 80).print(table)
    text = stream.getvalue()
    assert (text.count("Near start"), text.count("Far start")) == (1, 1)
    assert text.index("Near start") < text.index("Far start")


def test_english_report_has_no_chinese() -> None:
    text = shown(square_report(), "en")
    assert "Score 7.25 / 10" in text
    assert "✗ failed" in text
    assert not [character for character in text if "\u3000" <= character <= "\uffef"]


@pytest.mark.parametrize("language", ["zh", "en"])
@pytest.mark.parametrize("width", [60, 80, 120])
def test_no_line_is_wider_than_the_terminal(language: Language, width: int) -> None:
    run = outcome(
        status=RunStatus.CRASHED, error=crash(), cleanup_error=crash(), stdout=Stream(text="长" * 200)
    )
    graded = report(
        outcome=run, items=square_report().items, summary=t("很长的总结" * 30), hint=t("提示" * 60)
    )
    assert max(cell_len(line) for line in shown(graded, language, width, logs=True).split("\n")) <= width


def test_columns_line_up_under_chinese_text() -> None:
    lines = shown(square_report()).split("\n")
    rows = [line for line in lines if "2/2" in line or "1.25/2" in line or "0/2" in line]
    ends = {cell_len(line[: line.index("/2") + 2]) for line in rows}
    assert len(rows) == 5
    assert len(ends) == 1


def test_no_colour_when_not_a_terminal() -> None:
    assert "\x1b" not in shown(square_report())


def test_full_marks_are_said() -> None:
    assert "得分 10 / 10 满分" in shown(report())
    assert "满分" not in shown(square_report())


def test_pending_score() -> None:
    assert "得分 待评 / 10" in shown(report(score=None, status=GradeStatus.NEEDS_MANUAL))


def test_each_hint_is_said_once() -> None:
    hint = t("检查转弯时间。")
    items = tuple(item(ItemStatus.FAILED, id=str(i), hint=hint) for i in range(3))
    assert shown(report(hint=hint, items=items)).count("检查转弯时间。") == 1


def test_own_traceback() -> None:
    text = shown(report(score=0.0, status=GradeStatus.CRASHED, outcome=outcome(error=crash())))
    assert "你的程序在这里出错（第 31 行）" in text
    assert "msg.linear.x = 1" in text
    assert "AssertionError: The 'x' field must be of type 'float'" in text


def test_long_traceback_loses_its_middle() -> None:
    frames = "\n".join(f"  frame <{i}>" for i in range(1, 201))
    text = shown(
        report(outcome=outcome(error=StudentError(type="E", message="m", line=None, traceback=frames)))
    )
    assert "frame <1>" in text
    assert "frame <200>" in text
    assert "frame <100>" not in text
    assert "省略 160 行" in text


def test_error_in_clean_up_is_a_note() -> None:
    text = shown(report(outcome=outcome(cleanup_error=crash())))
    assert "不扣分" in text
    assert "得分 10 / 10 满分" in text
    assert "你的程序在这里出错" not in text


def test_notes_of_the_run() -> None:
    run = outcome(notes=(Note(code="wrong_topic", text="发布到了 /cmd_vel"),), nonfinite_commands=3)
    text = shown(report(outcome=run))
    assert "发布到了 /cmd_vel" in text
    assert "3 条速度命令" in text


def test_logs_only_on_demand() -> None:
    run = outcome(stdout=Stream(text="printed", dropped_bytes=77), logs_dropped=5)
    assert "printed" not in shown(report(outcome=run))
    text = shown(report(outcome=run), logs=True)
    assert "[   2.100] [INFO] [square_mover]: ✓ 直行完成" in text
    assert "printed" in text
    assert "77 字节" in text
    assert "另有 5 条日志" in text


def cases_report(*errors: StudentError | None) -> GradeReport:
    """Return the report of a case for each error."""
    return report(
        runs=tuple(
            CaseRun(case=f"case_{number}", outcome=outcome(error=error), trajectory_sha256="1" * 64)
            for number, error in enumerate(errors, 1)
        )
    )


def test_a_log_message_is_not_shown_again_among_the_output() -> None:
    console_line = "[INFO] [1700000002.100000000] [square_mover]: ✓ 直行完成"
    run = outcome(stderr=Stream(text=f"{console_line}\nTypeError"))
    text = shown(report(outcome=run), logs=True)
    assert text.count("✓ 直行完成") == 1
    assert "TypeError" in text


def test_an_error_of_every_case_is_shown_once() -> None:
    text = shown(cases_report(crash(), crash()))
    assert text.count("你的程序在这里出错") == 1
    assert "用例" not in text


def test_an_error_of_one_case_names_it_by_its_title() -> None:
    stream = io.StringIO()
    titles = {"case_2": t("输入 3", "Input 3")}
    graded = cases_report(None, crash())
    console(stream, 80).print(
        render_report(graded, language="zh", file_name="a.py", title=t("题", "Task"), cases=titles)
    )
    assert "你的程序在这里出错（第 31 行）（用例 输入 3）" in stream.getvalue()


def test_why_a_run_was_ended_is_said_once() -> None:
    run = outcome(status=RunStatus.STALLED, detail="a lock is held")
    assert shown(report(outcome=run, hint=t("其他"))).count("a lock is held") == 1
    assert shown(report(outcome=run, hint=t("卡住了：a lock is held。"))).count("a lock is held") == 1


def test_output_of_several_cases_is_named() -> None:
    text = shown(cases_report(None, None), logs=True)
    assert "用例 case_1" in text
    assert "用例 case_2" in text


def test_what_to_do_comes_before_the_table() -> None:
    text = shown(square_report())
    assert text.index("下一步") < text.index("评分项")


def test_a_passed_item_is_one_line() -> None:
    items = tuple(
        item(status, message=t(f"message of {status}"))
        for status in (ItemStatus.PASSED, ItemStatus.NOT_CHECKED, ItemStatus.FAILED)
    )
    text = shown(report(items=items))
    assert text.count("message of") == 1
    assert "message of failed" in text


def test_an_item_that_fails_in_several_cases_has_one_hint() -> None:
    items = tuple(item(ItemStatus.FAILED, id=f"{case}/sides", hint=t(f"提示 {case}")) for case in ("a", "b"))
    text = shown(report(items=items, mistakes=("sides_missing",)))
    assert "提示 a" in text
    assert "提示 b" not in text


def hostile_report(text: str) -> GradeReport:
    error = StudentError(type=text, message=text, line=3, traceback=text)
    run = RunOutcome(
        status=RunStatus.CRASHED,
        duration_ns=1,
        error=error,
        cleanup_error=error,
        detail=text,
        stdout=Stream(text=text),
        stderr=Stream(text=text),
        logs=(LogRecord(t_ns=1, level=20, name=text, message=text),),
        notes=(Note(code="x", text=text),),
    )
    items = (item(ItemStatus.FAILED, message=t(text), hint=t(text)),)
    return report(outcome=run, items=items, summary=t(text), hint=t(text))


def test_hostile_text_is_shown_not_obeyed() -> None:
    text = shown(hostile_report(HOSTILE), logs=True, width=200)
    assert "\x1b" not in text
    assert "\u202e" not in text
    assert "\\x1b[2J" in text
    assert "\\u202e" in text
    assert "[bold red]mark[/bold red]" in text
    assert ":smile:" in text


def test_the_console_reads_no_markup() -> None:
    stream = io.StringIO()
    console(stream, 80).print("[bold]x[/bold] :smile:")
    assert stream.getvalue() == "[bold]x[/bold] :smile:\n"


@given(st.text(st.characters(), max_size=60))
def test_any_text_prints_and_leaves_no_control_character(raw: str) -> None:
    text = shown(hostile_report(raw), logs=True)
    assert not [
        character
        for character in text
        if character != "\n" and (character < " " or "\x7f" <= character < "\xa0")
    ]
