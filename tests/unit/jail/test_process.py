"""What the kernel's account of a process's threads is taken to mean."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from grader.jail import process as module
from grader.jail.process import ProcessHandle

S = 1_000_000_000


@pytest.fixture
def waited_ns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., int | None]:
    """Return what a process has waited that used so much CPU time, from its threads' accounts (None: ended)."""

    def ask(cpu_ns: int, *accounts: str | None) -> int | None:
        for number, account in enumerate(accounts):
            (tmp_path / str(number)).mkdir()
            if account is not None:
                (tmp_path / str(number) / "schedstat").write_text(account)
        schedules = module._schedules
        monkeypatch.setattr(module, "_schedules", lambda _: schedules(str(tmp_path)))
        monkeypatch.setattr(ProcessHandle, "cpu_ns", lambda _: cpu_ns)
        return ProcessHandle(os.getpid(), None).waited_ns()

    return ask


def test_a_thread_alone_waits_for_the_host(waited_ns: Callable[..., int | None]) -> None:
    assert waited_ns(S, f"{S} {9 * S} 5\n") == 9 * S


def test_threads_that_wait_for_each_other_do_not_wait_for_the_host(
    waited_ns: Callable[..., int | None],
) -> None:
    assert waited_ns(30 * S, *[f"{S // 2} {29 * S} 5\n"] * 60) == 0


def test_one_that_waits_among_threads_that_rest_waits_for_the_host(
    waited_ns: Callable[..., int | None],
) -> None:
    assert waited_ns(2 * S, f"{2 * S} {9 * S} 5\n", *["1000000 0 1\n"] * 60) == 9 * S


def test_a_thread_that_ends_meanwhile_is_left_out(waited_ns: Callable[..., int | None]) -> None:
    assert waited_ns(S, f"{S} {9 * S} 5\n", None) == 9 * S


@pytest.mark.parametrize("account", [None, "0 0 0\n", "nonsense\n"])
def test_a_kernel_that_keeps_no_account_is_told_apart(
    waited_ns: Callable[..., int | None], account: str | None
) -> None:
    assert waited_ns(S, account) is None


@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="this kernel keeps no account")
def test_a_real_process_has_an_account() -> None:
    assert ProcessHandle(os.getpid(), None).waited_ns() is not None
