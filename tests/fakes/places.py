"""Somebody who has as much under way as they may."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager

from grader.contracts.errors import RefusedError
from tests.fakes.waiting import wait_until


@contextmanager
def all_taken(most: int, one_more: Callable[[], AbstractContextManager[None]]) -> Iterator[None]:
    """Take `most` places. That of a request whose answer has just been read becomes free a moment later."""
    with ExitStack() as taken:

        def take() -> bool:
            try:
                taken.enter_context(one_more())
            except RefusedError:
                return False
            return True

        for _ in range(most):
            wait_until(take)
        yield
