"""How long a report can get, whatever a script writes into it."""

import json
from typing import Any

from grader.contracts.outcome import Endpoint, LogRecord, Note, RunOutcome, RunStatus, Stream
from grader.grading.budget import CUT_NOTE, REPORT_TEXT_BYTES, within_budget

CONTROL = "\x01" * 1_000


def outcome(**fields: Any) -> RunOutcome:
    return RunOutcome(status=RunStatus.FINISHED, duration_ns=0, **fields)


def flood() -> RunOutcome:
    return outcome(
        stdout=Stream(text="\x01" * 131_072, dropped_bytes=7),
        stderr=Stream(text="\x01" * 131_072),
        logs=tuple(LogRecord(t_ns=n, level=20, name="n", message=CONTROL) for n in range(510)),
        notes=tuple(Note(code=f"n{n}", text=CONTROL) for n in range(100)),
        endpoints=tuple(
            Endpoint(kind="service", node="/n", name=f"/{'x' * 250}{n}", type="a/b") for n in range(500)
        ),
    )


def size(one: RunOutcome) -> int:
    texts = [one.stdout.text, one.stderr.text, *(log.message for log in one.logs)]
    texts += [note.text for note in one.notes] + [end.name for end in one.endpoints]
    return len(json.dumps(texts, ensure_ascii=False).encode())


def test_what_fits_stays_as_it_is() -> None:
    small = outcome(stdout=Stream(text="x" * 50_000), notes=(Note(code="a"),))
    wide = outcome(stdout=Stream(text="x" * 130_000), stderr=Stream(text="y" * 130_000))
    assert within_budget([small]) == [small]
    assert within_budget([wide]) == [wide]


def test_all_runs_of_a_flood_share_one_budget() -> None:
    for runs in (1, 3):
        cut = within_budget([flood() for _ in range(runs)])
        assert REPORT_TEXT_BYTES // 3 < sum(map(size, cut)) <= REPORT_TEXT_BYTES


def test_what_is_cut_bears_a_mark() -> None:
    (cut,) = within_budget([flood()])
    assert cut.notes[-1].code == CUT_NOTE
    assert cut.notes[-1].text == "notes, endpoints, logs, stdout, stderr"
    assert cut.logs_dropped + len(cut.logs) == 510
    assert "… cut" in cut.stdout.text
    kept = len(cut.stdout.text.replace("\n… cut: the report would be too long …\n", ""))
    assert cut.stdout.dropped_bytes == 7 + 131_072 - kept
