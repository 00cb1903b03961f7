"""Two processes that take turns share a core of their own, where the host lets them."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator

import pytest

from grader.jail import cores, libc
from grader.jail.cores import SharedCore

ALL = os.sched_getaffinity(0)
several = pytest.mark.skipif(len(ALL) < 2, reason="there is one core only")


@pytest.fixture(autouse=True)
def _apart_from_gradings_of_this_host(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cores, "_CLAIM", f"\0{os.getpid()}/core/{{}}")


@pytest.fixture
def other() -> Iterator[int]:
    """A process with two threads."""
    source = "import threading; threading.Thread(target=input).start(); print(flush=True); input()"
    with subprocess.Popen(
        [sys.executable, "-c", source], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        yield process.pid
        process.kill()


@contextlib.contextmanager
def sharing(pid: int) -> Iterator[SharedCore]:
    core = SharedCore(pid)
    core.share()
    try:
        yield core
    finally:
        core.part()


def cores_of(pid: int) -> list[set[int]]:
    return [os.sched_getaffinity(int(thread)) for thread in os.listdir(f"/proc/{pid}/task")]


def test_every_thread_shares_the_core_until_they_part(other: int) -> None:
    with sharing(other) as core:
        ours = os.sched_getaffinity(0)
        assert len(ours) == 1
        assert cores_of(other) == [ours, ours]
        core.share()
        assert os.sched_getaffinity(0) == ours
    assert os.sched_getaffinity(0) == ALL
    assert cores_of(other) == [ALL, ALL]


@several
def test_threads_that_take_turns_are_gathered_on_a_core_of_their_own(other: int) -> None:
    here = libc.present_core()
    core = SharedCore(other)
    core.gather()
    (taken,) = cores_of(other)[0]
    assert cores_of(other) == [{taken}, {taken}]
    assert (os.sched_getaffinity(0), taken) == (ALL, next(one for one in sorted(ALL) if one != here))
    core.leave()
    assert cores_of(other) == [ALL, ALL]


def test_gathered_threads_stay_together_when_their_process_and_this_one_part(other: int) -> None:
    core = SharedCore(other)
    core.gather()
    taken = cores_of(other)[0]
    for _ in range(2):
        core.share()
        assert os.sched_getaffinity(0) == taken
        core.part()
        assert os.sched_getaffinity(0) == ALL
        assert cores_of(other) == [taken, taken]
    core.share()
    core.leave()
    assert os.sched_getaffinity(0) == ALL
    assert cores_of(other) == [ALL, ALL]


def test_threads_are_gathered_where_both_are_already(other: int) -> None:
    with sharing(other) as core:
        taken = os.sched_getaffinity(0)
        core.gather()
        core.part()
        assert os.sched_getaffinity(0) == ALL
        assert cores_of(other) == [taken, taken]
        core.leave()
        assert cores_of(other) == [ALL, ALL]


@several
def test_two_pairs_never_share_one_core(other: int) -> None:
    with sharing(other) as core:
        taken = cores_of(other)[0]
        os.sched_setaffinity(0, ALL)  # as if another grading process asked
        with sharing(other) as second:
            assert cores_of(other)[0].isdisjoint(taken)
            second.part()
        core.part()


def test_whoever_finds_every_core_taken_goes_where_the_kernel_likes(other: int) -> None:
    with contextlib.ExitStack() as taken:
        for _ in ALL:
            taken.enter_context(sharing(other))
            os.sched_setaffinity(0, ALL)
        before = cores_of(other)
        with sharing(other):
            assert os.sched_getaffinity(0) == ALL
            assert cores_of(other) == before


def test_a_host_that_refuses_leaves_everything_as_it_was(other: int, monkeypatch: pytest.MonkeyPatch) -> None:
    allowed = os.sched_setaffinity

    def refuse(pid: int, wanted: set[int]) -> None:
        if pid:
            raise PermissionError(1, "Operation not permitted")
        allowed(pid, wanted)

    with monkeypatch.context() as patch:  # whose end leaves the fixtures' changes as they are
        patch.setattr(os, "sched_setaffinity", refuse)
        with sharing(other):
            assert os.sched_getaffinity(0) == ALL
    with sharing(other):  # the claim was given back
        assert len(os.sched_getaffinity(0)) == 1


def test_only_allowed_cores_are_taken(other: int) -> None:
    only = {max(ALL)}
    os.sched_setaffinity(0, only)
    try:
        with sharing(other):
            assert os.sched_getaffinity(0) == only
        assert os.sched_getaffinity(0) == only
    finally:
        os.sched_setaffinity(0, ALL)


def test_a_process_that_has_ended_is_no_matter() -> None:
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        process.wait()
    with sharing(process.pid):
        assert os.sched_getaffinity(0) == ALL


@several
def test_a_thread_that_ends_meanwhile_keeps_no_other_where_it_is(
    other: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    with subprocess.Popen([sys.executable, "-c", ""]) as gone:
        gone.wait()
    threads = os.listdir(f"/proc/{other}/task")
    with monkeypatch.context() as patch:
        patch.setattr(cores.os, "listdir", lambda _: [str(gone.pid), *threads])
        with sharing(other):
            ours = os.sched_getaffinity(0)
            assert len(ours) == 1
            assert [os.sched_getaffinity(int(thread)) for thread in threads] == [ours, ours]
    assert cores_of(other) == [ALL, ALL]
