"""The renderers' own words in both languages. What concerns one submission comes with its report."""

from collections.abc import Mapping

from grader.contracts.outcome import Note, RunStatus
from grader.contracts.report import GradeStatus
from grader.contracts.rubric import ItemStatus
from grader.contracts.text import Language, Text
from grader.messages.details import explained


def _t(zh: str, en: str) -> Text:
    return Text(zh=zh, en=en)


ITEM_STATUS: Mapping[ItemStatus, Text] = {
    ItemStatus.PASSED: _t("通过", "passed"),
    ItemStatus.PARTIAL: _t("部分", "partial"),
    ItemStatus.FAILED: _t("未过", "failed"),
    ItemStatus.NOT_CHECKED: _t("未查", "not checked"),
    ItemStatus.NEEDS_MANUAL: _t("待评", "waits"),
}

ITEM_MARK: Mapping[ItemStatus, str] = {
    ItemStatus.PASSED: "✓",
    ItemStatus.PARTIAL: "~",
    ItemStatus.FAILED: "✗",
    ItemStatus.NOT_CHECKED: "-",
    ItemStatus.NEEDS_MANUAL: "…",
}
"""Readable without colour."""

GRADE_STATUS: Mapping[GradeStatus, Text] = {
    GradeStatus.GRADED: _t("已评分", "graded"),
    GradeStatus.NEEDS_MANUAL: _t("等待人工评分", "waiting for a person"),
    GradeStatus.SYNTAX_ERROR: _t("语法错误，程序没有运行", "syntax error, the script did not run"),
    GradeStatus.CRASHED: _t("程序出错退出", "the script crashed"),
    GradeStatus.CPU_LIMIT: _t("用完了允许的 CPU 时间", "CPU time used up"),
    GradeStatus.MEMORY_LIMIT: _t("用完了允许的内存", "memory used up"),
    GradeStatus.OUTPUT_LIMIT: _t("输出太多", "too much output"),
    GradeStatus.STALLED: _t("程序卡住了", "the script waits for ever"),
    GradeStatus.FORBIDDEN: _t("做了不允许的操作", "did something not allowed"),
    GradeStatus.PROTOCOL: _t("干扰了与仿真器的通信", "interfered with the simulator's channel"),
}

RUN_STATUS: Mapping[RunStatus, Text] = {
    RunStatus.FINISHED: _t("程序正常结束", "the script finished"),
    RunStatus.INTERRUPTED: _t(
        "运行到时限，由 Ctrl+C 结束（正常）", "ran to the time limit, ended by Ctrl+C (normal)"
    ),
    RunStatus.SYNTAX_ERROR: GRADE_STATUS[GradeStatus.SYNTAX_ERROR],
    RunStatus.CRASHED: GRADE_STATUS[GradeStatus.CRASHED],
    RunStatus.STALLED: GRADE_STATUS[GradeStatus.STALLED],
    RunStatus.CPU_LIMIT: GRADE_STATUS[GradeStatus.CPU_LIMIT],
    RunStatus.MEMORY_LIMIT: GRADE_STATUS[GradeStatus.MEMORY_LIMIT],
    RunStatus.OUTPUT_LIMIT: GRADE_STATUS[GradeStatus.OUTPUT_LIMIT],
    RunStatus.FORBIDDEN: GRADE_STATUS[GradeStatus.FORBIDDEN],
    RunStatus.PROTOCOL: GRADE_STATUS[GradeStatus.PROTOCOL],
}

SUBMISSION_STATE: Mapping[str, Text] = {
    "queued": _t("排队", "queued"),
    "running": _t("评分中", "running"),
    "graded": _t("已评分", "graded"),
    "infrastructure_error": _t("故障", "fault"),
}

WALL: Mapping[str, Text] = {
    "left": _t("左墙", "the left wall"),
    "right": _t("右墙", "the right wall"),
    "top": _t("上墙", "the top wall"),
    "bottom": _t("下墙", "the bottom wall"),
}

NOTES: Mapping[str, Text] = {
    "wall": _t("小车撞到了{text}", "the car touched {text}"),
    "lateral_command": _t(
        "速度命令里有 linear.y，这辆车不能横着走，已忽略",
        "some commands set linear.y, which this car cannot follow: ignored",
    ),
    "clamped_command": _t(
        "有速度命令超过了小车的极限，按极限执行",
        "some commands exceeded what the car can do and were clamped",
    ),
    "type_mismatch": _t(
        "{text} 上的消息类型不对，连接不上", "the message type on {text} is a different one: not connected"
    ),
    "incompatible_qos": _t(
        "{text} 的 QoS 不兼容，连接不上", "the QoS on {text} is incompatible: not connected"
    ),
    "unreadable_message": _t("{text} 上有读不懂的消息，已丢弃", "unreadable messages on {text} were dropped"),
    "too_many_requests": _t(
        "对 {text} 的请求太多，已丢弃一部分", "too many requests to {text}: some were dropped"
    ),
    "discovery": _t(
        "{text} 的发布者刚创建就发消息，真机上最早的几条可能丢失",
        "{text} was published to right after creation; on a real robot the first messages may be lost",
    ),
    "thread_exception": _t("线程出错：{text}", "a thread failed: {text}"),
    "service_answer": _t("对服务调用的回应：{text}", "answer to a service call: {text}"),
    "forbidden": _t("不允许的操作：{text}", "not allowed: {text}"),
    "no_pictures": _t(
        "评分环境没有屏幕，{text} 的图不会画出来", "there is no screen here: {text} draws nothing"
    ),
}
"""Notes of a run by their code (see `grader.contracts.outcome.Note`)."""

WORDS: Mapping[str, Text] = {
    "score": _t("得分", "Score"),
    "full_marks": _t("满分", "full marks"),
    "not_yet": _t("待评", "pending"),
    "waiting_for_person": _t("等待人工评分", "waiting for a person"),
    "yes": _t("是", "yes"),
    "no": _t("否", "no"),
    "status": _t("状态", "Status"),
    "item": _t("评分项", "Rubric item"),
    "points": _t("得分", "Points"),
    "measured": _t("实测", "Measured"),
    "wanted": _t("要求", "Wanted"),
    "next_step": _t("下一步", "Next step"),
    "your_error": _t("你的程序在这里出错", "Your script failed here"),
    "at_line": _t("（第 {line} 行）", " (line {line})"),
    "case": _t("（用例 {case}）", " (case {case})"),
    "notes": _t("说明（不影响得分）", "Notes (cost nothing)"),
    "cleanup_error": _t(
        "Ctrl+C 之后的清理代码出错，不扣分：{error}",
        "the clean-up after Ctrl+C failed, which costs nothing: {error}",
    ),
    "nonfinite": _t(
        "{count} 条速度命令含 NaN 或无穷大，按 0 处理",
        "{count} velocity commands held NaN or infinity and counted as zero",
    ),
    "logs": _t("日志", "Log"),
    "stdout": _t("标准输出", "Standard output"),
    "stderr": _t("标准错误", "Standard error"),
    "left_out_lines": _t("… 省略 {count} 行 …", "… {count} lines left out …"),
    "left_out_bytes": _t("… 另有 {count} 字节未保留 …", "… {count} more bytes were not kept …"),
    "time": _t("时间", "Time"),
    "event": _t("事件", "Event"),
    "command": _t("速度命令", "command"),
    "repeated": _t("共 {count} 条，持续 {time}", "{count} messages over {time}"),
    "contact": _t("撞到{wall}", "touched {wall}"),
    "end": _t("结束", "end"),
    "student": _t("学生", "Student"),
    "assignment": _t("作业", "Assignment"),
    "pass_rate": _t("通过率", "Pass rate"),
    "mean": _t("平均分", "Mean"),
    "total": _t("总分", "Total"),
    "worth": _t("满分 {points}", "{points} points"),
    "time_limit": _t("，时限 {seconds} 虚拟秒", ", {seconds} virtual seconds"),
    "submissions": _t("提交", "Submissions"),
    "demo_graded": _t("{count} 份提交，评完用了 {seconds} 秒", "{count} submissions, graded in {seconds} s"),
    "demo_plots": _t("轨迹图：{plots}/", "plots: {plots}/"),
    "demo_pages": _t(
        "看网页：{program} serve --data {data}", "look at the pages: {program} serve --data {data}"
    ),
    "matrix_marks": _t(
        "✓ 满分  ✗ 不到 {share}  ×n 提交次数", "✓ full marks  ✗ less than {share}  ×n attempts"
    ),
    "hardest": _t("最常失分的评分项", "Most-failed rubric items"),
    "queue": _t("队列", "Queue"),
    "path": _t("行驶路径", "path"),
    "path_rest": _t("未计入的路径", "path not judged"),
    "ideal": _t("标准图形（拟合）", "ideal figure (fitted)"),
    "side_ok": _t("合格的边与角", "within tolerance"),
    "side_bad": _t("不合格的边与角", "out of tolerance"),
    "start": _t("起点", "start"),
    "stop": _t("终点", "end"),
    "wall": _t("墙", "wall"),
    "gap": _t("缺口 {length}", "gap {length}"),
    "time_axis": _t("时间 (s)", "time (s)"),
    "v_axis": _t("线速度 v (m/s)", "speed v (m/s)"),
    "w_axis": _t("角速度 ω (rad/s)", "yaw rate ω (rad/s)"),
    "turned_axis": _t("累计转角 (°)", "angle turned (°)"),
    "commanded": _t("命令", "commanded"),
    "driven": _t("实测", "measured"),
    "one_turn": _t("要求转角", "wanted turn"),
    "turned": _t("累计转角", "angle turned"),
    "no_motion": _t("小车没有动", "the car did not move"),
    "no_logs": _t("没有日志到达 /rosout", "no log message reached /rosout"),
    "running": _t("节点运行中", "script running"),
    "more_logs": _t("… 另有 {count} 条日志", "… {count} more log messages"),
}


def note_sentence(note: Note, language: Language) -> str:
    """Return what a note says; its raw text, not yet escaped, when the code is not known."""
    known = NOTES.get(note.code)
    if known is None:
        return note.text or note.code
    text = WALL.get(note.text) if note.code == "wall" else None
    if note.code == "forbidden":
        text = explained(RunStatus.FORBIDDEN, note.text)
    return known.get(language).format(text=text.get(language) if text else note.text)


def word(key: str, language: Language, **values: object) -> str:
    """Return one of `WORDS` in `language`, its fields filled in."""
    text = WORDS[key].get(language)
    return text.format(**values) if values else text
