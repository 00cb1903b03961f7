"""Sample reports, and motions made by an ideal turtle that obeys its commands exactly."""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from grader.contracts.assignment import Assignment, ItemSpec
from grader.contracts.figure import FigureSketch, SketchCorner, SketchSide
from grader.contracts.outcome import LogRecord, RunOutcome, RunStatus, StudentError
from grader.contracts.report import CaseRun, GradeReport, GradeStatus
from grader.contracts.rubric import ItemStatus, RubricItem
from grader.contracts.text import Text
from grader.contracts.trajectory import Command, Contact, Trajectory

SECOND = 1_000_000_000
STEP_S = 1 / 60
START_M = 5.544445
FIGURES = {"square": (4, 90.0), "triangle": (3, 120.0), "pentagon": (5, 72.0)}


def t(zh: str, en: str | None = None) -> Text:
    return Text(zh=zh, en=zh if en is None else en)


@dataclass
class IdealTurtle:
    """Integrates (v, w) exactly over steps of 1/60 s and remembers where it turned."""

    x_m: float = START_M
    y_m: float = START_M
    heading_rad: float = 0.0
    time_s: float = 0.0
    rows: list[tuple[float, float, float, float, float, float]] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.rows.append((self.time_s, self.x_m, self.y_m, self.heading_rad, 0.0, 0.0))

    def go(self, v_mps: float, w_radps: float, seconds: float) -> "IdealTurtle":
        steps = max(round(seconds / STEP_S), 1)
        step_s = seconds / steps
        for i in range(steps):
            if i % 6 == 0:
                self.commands.append(Command(t_ns=round(self.time_s * SECOND), v_mps=v_mps, w_radps=w_radps))
            middle = self.heading_rad + w_radps * step_s / 2
            self.x_m += v_mps * np.cos(middle) * step_s
            self.y_m += v_mps * np.sin(middle) * step_s
            self.heading_rad += w_radps * step_s
            self.time_s += step_s
            self.rows.append((self.time_s, self.x_m, self.y_m, self.heading_rad, v_mps, w_radps))
        return self

    def stop(self, seconds: float = 0.5) -> "IdealTurtle":
        return self.go(0.0, 0.0, seconds)

    def trajectory(self, contacts: tuple[Contact, ...] = ()) -> Trajectory:
        table = np.array(self.rows, dtype=np.float64)
        t_ns = np.round(table[:, 0] * SECOND).astype(np.int64)
        return Trajectory(
            t_ns=t_ns,
            x_m=table[:, 1],
            y_m=table[:, 2],
            heading_rad=table[:, 3],
            v_mps=table[:, 4],
            w_radps=table[:, 5],
            end_ns=int(t_ns[-1]),
            contacts=contacts,
            commands=tuple(self.commands),
        )


def polygon(
    sides_m: list[float], turns_deg: list[float], *, v: float = 1.0, w: float = 1.0, heading_deg: float = 0.0
) -> tuple[Trajectory, list[tuple[float, float]]]:
    """Drive sides and turns alternately; return the motion and the vertices."""
    turtle = IdealTurtle(heading_rad=np.deg2rad(heading_deg)).stop(0.3)
    vertices = [(turtle.x_m, turtle.y_m)]
    for side, turn in zip(sides_m, turns_deg, strict=True):
        turtle.go(v, 0.0, side / v).stop(0.4)
        vertices.append((turtle.x_m, turtle.y_m))
        angle = np.deg2rad(turn)
        turtle.go(0.0, np.sign(angle) * w, abs(angle) / w).stop(0.4)
    return turtle.trajectory(), vertices


def polygon_sketch(
    vertices: list[tuple[float, float]],
    turns_deg: list[float],
    *,
    side_m: float,
    turn_deg: float,
    ideal: list[tuple[float, float]],
) -> FigureSketch:
    sides = tuple(
        SketchSide(
            start_m=a,
            end_m=b,
            length_m=(d := float(np.hypot(b[0] - a[0], b[1] - a[1]))),
            ok=abs(d - side_m) <= 0.08 * side_m,
        )
        for a, b in pairwise(vertices)
    )
    corners = tuple(
        SketchCorner(at_m=at, angle_deg=angle, ok=abs(abs(angle) - turn_deg) <= 6)
        for at, angle in zip(vertices[1:], turns_deg, strict=True)
    )
    end, start = vertices[-1], vertices[0]
    distance = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    gap = SketchSide(start_m=end, end_m=start, length_m=distance, ok=False) if distance > 0.1 else None
    return FigureSketch(sides=sides, corners=corners, ideal_m=tuple(ideal), gap=gap)


def regular(n: int, side_m: float, heading_deg: float = 0.0, left: bool = True) -> list[tuple[float, float]]:
    x, y, heading = START_M, START_M, np.deg2rad(heading_deg)
    vertices = [(x, y)]
    for _ in range(n - 1):
        x, y = x + side_m * np.cos(heading), y + side_m * np.sin(heading)
        heading += (1 if left else -1) * 2 * np.pi / n
        vertices.append((float(x), float(y)))
    return vertices


def item(status: ItemStatus = ItemStatus.PASSED, **changes: object) -> RubricItem:
    values: dict[str, object] = {
        "id": "sides",
        "title": t("四条边", "Four sides"),
        "points": 2.0,
        "earned": 2.0 if status is ItemStatus.PASSED else 0.0,
        "status": status,
    }
    return RubricItem(**(values | changes))  # type: ignore[arg-type]


def outcome(**changes: object) -> RunOutcome:
    values: dict[str, object] = {
        "status": RunStatus.FINISHED,
        "duration_ns": 16 * SECOND,
        "logs": (
            LogRecord(t_ns=1_000_000, level=20, name="square_mover", message="🎯 正方形控制节点启动!"),
            LogRecord(t_ns=2_100_000_000, level=20, name="square_mover", message="✓ 直行完成"),
        ),
    }
    return RunOutcome(**(values | changes))  # type: ignore[arg-type]


def report(**changes: object) -> GradeReport:
    run = changes.pop("outcome", outcome())
    values: dict[str, object] = {
        "submission_sha256": "0" * 64,
        "assignment": "square",
        "assignment_version": 1,
        "grader_version": "0.1.0",
        "simulator": "pybullet",
        "seed": 0,
        "status": GradeStatus.GRADED,
        "score": 10.0,
        "max_score": 10.0,
        "items": (item(),),
        "runs": (CaseRun(case="default", outcome=run, trajectory_sha256="1" * 64),),  # type: ignore[arg-type]
    }
    return GradeReport(**(values | changes))  # type: ignore[arg-type]


def square_report() -> GradeReport:
    """A square with one side too short, as the checks would judge it."""
    return report(
        score=7.25,
        summary=t(
            "是四条边的图形,但边长不相等,也没有回到起点。",
            "Four sides, but not equal, and it does not close.",
        ),
        hint=t(
            "检查第 3 条边的行驶时间:时间 = 边长 ÷ 速度。", "Check the time of side 3: time = length / speed."
        ),
        items=(
            item(
                id="sides",
                measured=4.0,
                target=4.0,
                tolerance=0.0,
                message=t("检测到 4 条边。", "4 sides found."),
            ),
            item(
                ItemStatus.FAILED,
                id="equal",
                title=t("边长相等", "Equal sides"),
                measured=18.4,
                target=0.0,
                tolerance=5.0,
                unit="%",
                wanted=t("不超过 5 %", "at most 5 %"),
                message=t("第 3 条边 1.62 m,其余约 2.00 m。", "Side 3 is 1.62 m."),
            ),
            item(
                id="angles",
                title=t("外角 90°", "Exterior angles 90°"),
                measured=90.2,
                target=90.0,
                tolerance=3.0,
                unit="deg",
                wanted=t("90° ± 3°"),
            ),
            item(
                ItemStatus.PARTIAL,
                id="closed",
                title=t("回到起点", "Back at the start"),
                earned=1.25,
                measured=0.38,
                target=0.0,
                tolerance=0.1,
                unit="m",
                wanted=t("不超过 0.1 m", "at most 0.1 m"),
                hint=t("四条边一样长时,图形就会闭合。", "It closes when all sides are equal."),
            ),
            item(ItemStatus.NOT_CHECKED, id="rest", title=t("最后停下", "At rest at the end")),
        ),
    )


def crash() -> StudentError:
    return StudentError(
        type="AssertionError",
        message="The 'x' field must be of type 'float'",
        line=31,
        traceback='Traceback (most recent call last):\n  File "square_mover.py", line 31, in <module>\n'
        "    msg.linear.x = 1\nAssertionError: The 'x' field must be of type 'float'\n",
    )


def assignment(id: str = "square", title: Text | None = None, **changes: object) -> Assignment:
    values: dict[str, object] = {
        "id": id,
        "version": 1,
        "order": 5,
        "title": title or t("正方形", "Square"),
        "brief": t(""),
        "check": "polygon",
        "items": (ItemSpec(id="sides", title=t("四条边"), points=10.0, measure="sides"),),
    }
    return Assignment(**(values | changes))  # type: ignore[arg-type]


def figure_of(name: str, wrong: bool = False, heading_deg: float = 0.0) -> tuple[Trajectory, FigureSketch]:
    count, turn = FIGURES[name]
    sides, turns = [2.0] * count, [turn] * count
    if wrong:
        sides[2], turns[1] = 1.62, turn - 9
    motion, vertices = polygon(sides, turns, heading_deg=heading_deg)
    ideal = regular(count, 2.0, heading_deg)
    return motion, polygon_sketch(vertices, turns, side_m=2.0, turn_deg=turn, ideal=ideal)
