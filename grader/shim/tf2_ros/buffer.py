"""The buffer of transforms that a script asks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy import _distro
from rclpy._forwarding import forwarding
from rclpy._kernel import kernel
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.task import Future
from rclpy.time import Time
from tf2_msgs.srv import FrameGraph
from tf2_py import BufferCore

from tf2_ros.buffer_interface import BufferInterface

_NO_TIMEOUT = Duration()
_POLL_NS = 20_000_000  # tf2_ros polls every 20 ms while it waits

__getattr__ = forwarding(__name__, {"geometry_msgs.msg": "TransformStamped", "rclpy.node": "Node"})


class Buffer(BufferCore, BufferInterface):
    """Keeps the transforms it is given and answers for the frames between them.

    Args:
        cache_time: how long the past is remembered (10 s when left out).
        node: offers the service ``tf2_frames`` on it, when given.
    """

    def __init__(self, cache_time: Any = None, node: Any = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._waiting: list[tuple[Future, Callable[[], bool], Callable[[], Any]]] = []
        if node is not None:
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._get_frames)

    def _get_frames(self, request: Any, response: Any) -> Any:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def set_transform(self, transform: Any, authority: str) -> None:
        """Take in the pose of a moving frame."""
        super().set_transform(transform, authority)
        self._settle()

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Take in the pose of a fixed frame."""
        super().set_transform_static(transform, authority)
        self._settle()

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Time, timeout: Duration = _NO_TIMEOUT
    ) -> Any:
        """Return the pose of `source_frame` in `target_frame`, waiting up to `timeout` for it.

        Raises TransformException: its subclass tells why there is none.
        """
        self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Time) -> Any:
        """Return the pose of `source_frame` in `target_frame` once it is known."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Time,
        source_frame: str,
        source_time: Time,
        fixed_frame: str,
        timeout: Duration = _NO_TIMEOUT,
    ) -> Any:
        """Return the pose of `source_frame` at one time in `target_frame` at another.

        Raises TransformException: its subclass tells why there is none.
        """
        question = (target_frame, target_time, source_frame, source_time, fixed_frame)
        self.can_transform_full(*question, timeout)
        return self.lookup_transform_full_core(*question)

    async def lookup_transform_full_async(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time, fixed_frame: str
    ) -> Any:
        """Return what `lookup_transform_full` does, once it is known."""
        question = (target_frame, target_time, source_frame, source_time, fixed_frame)
        await self.wait_for_transform_full_async(*question)
        return self.lookup_transform_full_core(*question)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Time,
        timeout: Duration = _NO_TIMEOUT,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether the transform is or becomes known within `timeout`; with the reason if asked for."""
        answer = self._wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        return answer if return_debug_tuple else answer[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Time,
        source_frame: str,
        source_time: Time,
        fixed_frame: str,
        timeout: Duration = _NO_TIMEOUT,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether `lookup_transform_full` would succeed within `timeout`, and why not if asked for."""
        question = (target_frame, target_time, source_frame, source_time, fixed_frame)
        answer = self._wait(lambda: self.can_transform_full_core(*question), timeout)
        return answer if return_debug_tuple else answer[0]

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Time) -> Future:
        """Return a future that is done when the transform is known: with True or, on Jazzy, with the transform."""
        question = (target_frame, source_frame, time)
        return self._future(
            lambda: self.can_transform_core(*question)[0], lambda: self.lookup_transform_core(*question)
        )

    def wait_for_transform_full_async(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time, fixed_frame: str
    ) -> Future:
        """Return a future that is done when `lookup_transform_full` would succeed: with True, or what it does."""
        question = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return self._future(
            lambda: self.can_transform_full_core(*question)[0],
            lambda: self.lookup_transform_full_core(*question),
        )

    def _wait(self, ask: Callable[[], tuple[bool, str]], timeout: Duration) -> tuple[bool, str]:
        deadline_ns = kernel.now_ns
        # What is no Duration is a TypeError, as upstream: on Humble by the comparison, on Jazzy by the sum.
        if timeout != _NO_TIMEOUT:
            Clock().now() + timeout
            deadline_ns += timeout.nanoseconds
        answer = ask()
        while not answer[0] and kernel.now_ns < deadline_ns:
            kernel.sleep_ns(_POLL_NS)
            answer = ask()
        return answer

    def _future(self, known: Callable[[], bool], look_up: Callable[[], Any]) -> Future:
        future = Future()
        result = look_up if _distro.chosen == _distro.JAZZY else lambda: True
        if known():
            future.set_result(result())
        else:
            self._waiting.append((future, known, result))
        return future

    def _settle(self) -> None:
        """Finish the futures whose transforms have become known, and forget those done otherwise."""
        waiting, self._waiting = self._waiting, []
        for future, known, result in waiting:
            if not future.done() and known():
                future.set_result(result())
            elif not future.done():
                self._waiting.append((future, known, result))
