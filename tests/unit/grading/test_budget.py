"""How long a report can get, whatever a script writes into it."""

import json
from typing import Any

from grader.contracts.outcome import Endpoint, LogRecord, Note, RunOutcome, RunStatus, Stream, StudentError
from grader.contracts.record import to_plain
from grader.contracts.report import CaseOutput
from grader.grading.budget import CUT_NOTE, REPORT_TEXT_BYTES, outputs_within_budget, within_budget

CONTROL = "\x01" * 1_000


def outcome(**fields: Any) -> RunOutcome:
    return RunOutcome(status=RunStatus.FINISHED, duration_ns=0, **fields)


def flood() -> RunOutcome:
    return outcome(
        stdout=Stream(text="\x01" * 131_072, dropped_bytes=7),
        stderr=Stream(text="\x01" * 131_072),
        logs=tuple(LogRecord(t_ns=n, level=20, name="n", message=CONTROL) for n in range(510)),
        notes=tuple(Note(code=f"n{n}", text=CONTROL) for n in range(100)),
        error=StudentError(type="E" * 1_000, message="\x01" * 4_096, line=1, traceback="\x01" * 16_384),
        detail="\x01" * 16_384,
        nodes=tuple(f"/{'x' * 495}{n}" for n in range(500)),
        endpoints=tuple(
            Endpoint(kind="service", node="/n", name=f"/{'x' * 250}{n}", type="a/b") for n in range(500)
        ),
    )


def size(one: RunOutcome) -> int:
    return len(json.dumps(to_plain(one), default=to_plain, ensure_ascii=False).encode())


def test_what_fits_stays_as_it_is() -> None:
    small = outcome(stdout=Stream(text="x" * 50_000), notes=(Note(code="a"),))
    wide = outcome(stdout=Stream(text="x" * 130_000), stderr=Stream(text="y" * 130_000))
    assert within_budget([small]) == [small]
    assert within_budget([wide]) == [wide]


def test_all_runs_of_a_flood_share_one_budget() -> None:
    for runs in (1, 3, 20):
        cut = within_budget([flood() for _ in range(runs)])
        assert REPORT_TEXT_BYTES // 3 < sum(map(size, cut)) <= REPORT_TEXT_BYTES


def test_what_is_cut_bears_a_mark() -> None:
    (cut,) = within_budget([flood()])
    assert cut.notes[-1].code == CUT_NOTE
    assert cut.notes[-1].text == "error, detail, notes, nodes, endpoints, logs, stdout, stderr"
    assert cut.logs_dropped + len(cut.logs) == 510
    assert "… cut" in cut.stdout.text
    kept = len(cut.stdout.text.replace("\n… cut: the report would be too long …\n", ""))
    assert cut.stdout.dropped_bytes == 7 + 131_072 - kept


def test_output_beside_the_report_is_cut_as_well() -> None:
    outputs = [CaseOutput(case="a", stdout=flood().stdout, stderr=flood().stderr)] * 3
    kept = json.dumps(outputs_within_budget(outputs), default=to_plain)
    assert REPORT_TEXT_BYTES // 2 < len(kept) <= REPORT_TEXT_BYTES
    small = CaseOutput(case="a", stdout=Stream(text="x"), stderr=Stream())
    assert outputs_within_budget([small]) == (small,)
