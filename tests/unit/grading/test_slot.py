"""The parent's side of a grading process, with small children that answer, die, hang or babble."""

import gc
import json
import os
import signal
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from grader.contracts.assignment import Assignment, Case, Limits
from grader.contracts.errors import InfrastructureError, NoRoomError, SandboxUnavailableError
from grader.contracts.grading import GradingJob, RunProgress
from grader.contracts.text import EMPTY
from grader.grading import child, launch, slot
from grader.grading.launch import Child
from grader.grading.slot import Channel, Slot, SlotConfig
from tests.fakes.processes import process_of
from tests.fakes.waiting import PATIENCE_S, wait_until

ASSIGNMENT = Assignment(
    id="demo",
    version=1,
    order=1,
    title=EMPTY,
    brief=EMPTY,
    check="node",
    items=(),
    limits=Limits(wall_s=1.0),
    cases=(Case(),),
)
JOB = GradingJob(file_name="a.py", source=b"x" * 200_000, assignment=ASSIGNMENT)
REPORT = {
    "submission_sha256": "0",
    "assignment": "demo",
    "assignment_version": 1,
    "grader_version": "0",
    "simulator": "none",
    "seed": 0,
    "status": "graded",
    "score": 1.0,
    "max_score": 1.0,
    "items": [],
    "runs": [],
}
MEASUREMENTS = {"wall_s": 0.0, "jail_cpu_s": 0.0, "jail_peak_bytes": 0, "sim_steps": 0, "isolation": "none"}
CHILD = f"""
import json, os, signal, sys, time
requests, answers = map(int, sys.argv[1:3])
def read(size):
    data = b""
    while len(data) < size:
        part = os.read(requests, size - len(data))
        if not part: sys.exit(0)
        data += part
    return data
def receive():
    message = json.loads(read(int.from_bytes(read(4), "little")))
    for size in message.get("blobs", ()): read(size)
    return message
def write(data):
    while data: data = data[os.write(answers, data):]
def send(message, *blobs):
    data = json.dumps(dict(message, blobs=[len(one) for one in blobs]) if blobs else message).encode()
    write(len(data).to_bytes(4, "little") + data + b"".join(blobs))
config = receive()
REPORT = json.dumps({REPORT!r}).encode()
RESULT = {{"kind": "result", "trajectories": ["default"],
          "measurements": dict({MEASUREMENTS!r}, isolation=config["mode"]), "requests": {{}}, "unmet": []}}
BLOBS = REPORT, b"t" * 200_000
def serve():
    while True:
        receive()
        send(RESULT, *BLOBS)
"""


@pytest.fixture
def children(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The programs of the next children, after the common part above; the last one is used again."""
    programs: list[str] = []

    def start() -> Child:
        program = programs.pop(0) if len(programs) > 1 else programs[0]
        monkeypatch.setattr(launch, "_BOOTSTRAP", f"import sys; del sys.argv[1]\n{CHILD}\n{program}")
        return launch.launch()

    monkeypatch.setattr(slot, "launch", start)
    return programs


def children_of(task: Path) -> list[str]:
    """What a thread started; nothing where it has just ended."""
    try:
        return (task / "children").read_text().split()
    except (FileNotFoundError, ProcessLookupError):
        return []


def offspring() -> set[str]:
    """Every child of this process, those that nobody waited for included."""
    tasks = Path("/proc/self/task").glob("*")  # none where there is no /proc
    return {child for task in tasks for child in children_of(task)}


def family(pid: str) -> set[str]:
    """A process and all it started that still run."""
    return {pid}.union(*map(family, children_of(Path(f"/proc/{pid}/task/{pid}"))))


def descriptors() -> set[str]:
    if sys.platform != "linux":
        return set()
    return {fd for fd in os.listdir("/proc/self/fd") if os.path.lexists(f"/proc/self/fd/{fd}")}


def test_one_child_serves_one_job_after_the_other(children: list[str]) -> None:
    children.append("serve()")
    with Slot(SlotConfig(mode="dev")) as one:
        results = [one.grade(JOB) for _ in range(3)]
    assert [result.measurements.isolation for result in results] == ["dev"] * 3
    assert results[0].trajectories["default"] == b"t" * 200_000


def test_a_child_tells_how_far_a_run_is_when_it_is_asked_to(children: list[str]) -> None:
    told = {"t_ns": 5, "stdout": "a", "stderr": ""}
    children.append(f"""
while True:
    job = receive()
    send({{"kind": "running"}})
    if job["tells"]: send({{"kind": "progress", "progress": {told!r}}})
    send(RESULT, *BLOBS)
""")
    runs, seen = [], []
    with Slot(SlotConfig()) as one:
        one.grade(JOB, lambda: runs.append(1), seen.append)
        assert (runs, seen) == ([1], [RunProgress(t_ns=5, stdout="a")])
        one.grade(JOB)
    assert len(seen) == 1


def test_progress_that_is_none_is_a_fault(children: list[str]) -> None:
    children.append("receive(); send({'kind': 'progress', 'progress': {'t_ns': 'soon'}})")
    with Slot(SlotConfig()) as one, pytest.raises(InfrastructureError):
        one.grade(JOB, lambda: None, print)


def standing(pid: str) -> tuple[int, int, str]:
    """How a process stands against others: niceness, scheduling class, and its session's niceness."""
    group = Path(f"/proc/{pid}/autogroup")
    niceness = group.read_text().split()[-1] if group.exists() else "7"
    return os.getpriority(os.PRIO_PROCESS, int(pid)), os.sched_getscheduler(int(pid)), niceness


def is_for_a_script(pid: str) -> bool:
    """Whether a process of a slot has a group of its own in another's session."""
    return os.getpgid(int(pid)) == int(pid) != os.getsid(int(pid))


@pytest.mark.skipif(sys.platform != "linux", reason="scheduling classes are Linux'")
def test_a_nice_child_gives_way_with_all_it_starts() -> None:
    before = os.getpriority(os.PRIO_PROCESS, 0)
    nice = min(before + 7, 19)  # the most there is: whoever runs the tests may give way already
    with Slot(SlotConfig(mode="best-effort", niceness=nice)) as one:
        one.grade(replace(JOB, source=b"pass"))
        grading = str(process_of(one)._pid)
        wait_until(lambda: any(map(is_for_a_script, family(grading))))  # made once nobody waits
        assert {standing(pid) for pid in family(grading)} == {(nice, os.SCHED_BATCH, str(nice))}
    assert os.getpriority(os.PRIO_PROCESS, 0) == before


def test_a_child_that_dies_is_replaced(children: list[str]) -> None:
    children += ["receive(); sys.exit(7)", "serve()"]
    with Slot(SlotConfig()) as one:
        with pytest.raises(InfrastructureError, match=r"unexpectedly \(exit code 7\)"):
            one.grade(JOB)
        assert one.grade(JOB).report.score == 1.0


def test_a_child_that_dies_before_it_is_asked_is_replaced(children: list[str]) -> None:
    children += ["sys.exit(7)", "serve()"]
    with Slot(SlotConfig()) as one:
        assert process_of(one).wait(30.0) == 7
        assert one.grade(JOB).report.score == 1.0


def test_a_child_that_is_killed_is_named_by_its_signal(children: list[str]) -> None:
    children.append("receive(); os.kill(os.getpid(), signal.SIGSEGV)")
    with Slot(SlotConfig()) as one, pytest.raises(InfrastructureError, match="exit code -11"):
        one.grade(JOB)


@pytest.mark.parametrize(
    "program",
    [
        pytest.param("time.sleep(600)", id="reads nothing"),
        pytest.param("receive(); time.sleep(600)", id="answers nothing"),
        pytest.param("receive(); write(b'\\x10\\0\\0\\0half'); time.sleep(600)", id="answers half"),
    ],
)
def test_a_child_that_hangs_is_ended(
    children: list[str], program: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(slot, "_SPARE_S", 0.3)
    monkeypatch.setattr(slot.bounds, "longest_run_s", lambda wall_s: 0.0)
    children.append(program)
    with Slot(SlotConfig()) as one:
        process = process_of(one)
        assert process is not None
        with pytest.raises(InfrastructureError, match="no answer in time"):
            one.grade(JOB)
        assert process.exit_code() == -signal.SIGKILL


def test_a_child_has_the_time_of_one_run_from_one_answer_to_the_next(
    children: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    budgets = []
    receive = slot.Channel.receive

    def noting(self: slot.Channel, budget_s: float | None = None) -> object:
        budgets.append(budget_s)
        return receive(self, budget_s)

    monkeypatch.setattr(slot.Channel, "receive", noting)
    children.append("receive(); send({'kind': 'running'}); send(RESULT, *BLOBS)")
    cases = tuple(Case(id=f"case{number}") for number in range(20))
    with Slot(SlotConfig()) as one:
        one.grade(replace(JOB, assignment=replace(ASSIGNMENT, limits=Limits(wall_s=120.0), cases=cases)))
    assert budgets == [630.0, 630.0]


@pytest.mark.parametrize(
    "program",
    [
        pytest.param("write(b'\\4\\0\\0\\0nope')", id="no JSON"),
        pytest.param("write(b'\\2\\0\\0\\0[]')", id="no object"),
        pytest.param("write(b'\\xff\\xff\\xff\\xff')", id="4 GiB announced"),
        pytest.param("send({})", id="no kind"),
        pytest.param("send({'kind': 'result'})", id="no report"),
        pytest.param("send(RESULT, b'3', b'')", id="report is a number"),
        pytest.param("send(RESULT, REPORT)", id="no blob for the trajectory"),
        pytest.param("send(dict(RESULT, trajectories=1), *BLOBS)", id="trajectories are a number"),
        pytest.param("send(dict(RESULT, blobs=[-1, 1]))", id="a blob of less than nothing"),
        pytest.param("send(dict(RESULT, blobs=[1 << 40]))", id="a TiB of blobs announced"),
        pytest.param("send(dict(RESULT, blobs=[9])); write(b'half')", id="half a blob"),
        pytest.param("send({'kind': 'fault', 'message': 'the car melted'})", id="a fault"),
        pytest.param("write(b'\\x10\\0\\0\\0half')", id="half an answer"),
        pytest.param("os.close(answers)", id="closes its end and goes on"),
    ],
)
def test_nonsense_is_an_infrastructure_error_and_the_next_grading_works(
    children: list[str], program: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(slot, "_EXIT_S", 0.05)
    goes_on = "half" in program or "close" in program
    children += [f"receive(); {program}; " + ("os._exit(0)" if "half" in program else "serve()"), "serve()"]
    with Slot(SlotConfig()) as one:
        with pytest.raises(InfrastructureError):
            one.grade(JOB)
        if goes_on:
            assert process_of(one) is None
        assert one.grade(JOB).report.score == 1.0


def test_a_host_that_cannot_isolate_is_told_apart(children: list[str]) -> None:
    children.append("receive(); send({'kind': 'unavailable', 'message': 'no landlock'}); serve()")
    with Slot(SlotConfig()) as one, pytest.raises(SandboxUnavailableError, match="no landlock"):
        one.grade(JOB)


@pytest.mark.parametrize(
    "program",
    [
        pytest.param("send({'kind': 'no_room', 'message': '[Errno 11]'}); serve()", id="told"),
        pytest.param("sys.exit(75)", id="no thread for the grading process itself"),
        pytest.param("os.kill(os.getpid(), signal.SIGKILL)", id="killed by the kernel"),
    ],
)
def test_a_host_that_has_nothing_to_spare_is_told_apart(children: list[str], program: str) -> None:
    children.append(f"receive(); {program}")
    with Slot(SlotConfig()) as one, pytest.raises(NoRoomError):
        one.grade(JOB)


def test_a_grading_process_that_is_killed_while_the_script_runs_counts_as_a_try(children: list[str]) -> None:
    children.append("receive(); send({'kind': 'running'}); os.kill(os.getpid(), signal.SIGKILL)")
    with Slot(SlotConfig()) as one, pytest.raises(InfrastructureError) as error:
        one.grade(JOB)
    assert type(error.value) is InfrastructureError


def test_a_second_case_that_cannot_be_started_waits_as_the_first_does(children: list[str]) -> None:
    children.append("receive(); send({'kind': 'running'}); send({'kind': 'no_room', 'message': ''}); serve()")
    with Slot(SlotConfig()) as one, pytest.raises(NoRoomError):
        one.grade(JOB)


def test_a_grading_process_that_finds_no_room_for_itself_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: object) -> None:
        raise RuntimeError("can't start new thread")

    requests, answers = os.pipe()
    channel = Channel(*map(os.dup, (requests, answers)))
    channel.send({})
    monkeypatch.setattr(child, "script_sandbox", refuse)
    assert child.main([str(requests), str(answers)]) == 75
    for descriptor in (requests, answers):
        os.close(descriptor)
    channel.close()


def test_abort_from_another_thread_ends_a_grading_under_way(children: list[str]) -> None:
    children += ["receive(); send({'kind': 'running'}); time.sleep(600)", "serve()"]
    with Slot(SlotConfig()) as one:
        killer = threading.Thread(target=one.abort)
        with pytest.raises(InfrastructureError, match="exit code -9"):
            one.grade(JOB, killer.start)
        killer.join()
        one.abort()  # nothing runs: no matter
        assert one.grade(JOB).report.score == 1.0


def test_the_whole_group_ends_with_the_slot(children: list[str], tmp_path: Path) -> None:
    note = tmp_path / "pid"
    children.append(
        f"pid = os.fork()\nif pid == 0: time.sleep(600)\nopen({str(note)!r}, 'w').write(str(pid))\nserve()"
    )
    with Slot(SlotConfig()) as one:
        one.grade(JOB)
        grandchild = int(note.read_text())
        os.kill(grandchild, 0)
    wait_until(lambda: _has_ended(grandchild))


def test_a_child_whose_parent_is_gone_ends_without_a_word(capfd: pytest.CaptureFixture[str]) -> None:
    with Slot(SlotConfig(mode="dev")) as one:
        assert one._channel is not None
        one._channel.send(slot._request(JOB), [JOB.source], PATIENCE_S)
        one._channel.close()
        one._channel = None
        assert process_of(one).wait(PATIENCE_S) == 0
    assert capfd.readouterr().err == ""


def test_nothing_stays_open_and_no_child_is_left(children: list[str]) -> None:
    children += ["receive(); sys.exit(1)", "receive(); write(b'\\4\\0\\0\\0nope')", "serve()"]
    gc.collect()  # what other tests left open is not closed meanwhile
    before = descriptors(), offspring()
    with Slot(SlotConfig()) as one:
        for _ in range(2):
            with pytest.raises(InfrastructureError):
                one.grade(JOB)
        one.grade(JOB)
    one.close()
    assert (descriptors(), offspring()) == before


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_a_child_holds_no_pipe_of_another(children: list[str], tmp_path: Path) -> None:
    note = tmp_path / "open"
    links = "[os.readlink(e.path) for e in os.scandir('/proc/self/fd') if os.path.lexists(e.path)]"
    children += ["serve()", f"open({str(note)!r}, 'w').write(json.dumps({links}))\nserve()"]
    before = descriptors()
    with Slot(SlotConfig()) as first:
        first.grade(JOB)
        of_the_first = {os.readlink(f"/proc/self/fd/{fd}") for fd in descriptors() - before}
        with Slot(SlotConfig()) as second:
            second.grade(JOB)
    assert len(of_the_first) == 2
    assert not of_the_first & set(json.loads(note.read_text()))


def _has_ended(pid: int) -> bool:
    """Whether a process that is not our child is gone, or a zombie nobody reaps."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True
