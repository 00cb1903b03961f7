"""Service clients."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy._kernel import kernel
from rclpy.task import Future

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rclpy._rcl.service_endpoints import ClientHandle
    from rclpy.callback_groups import CallbackGroup
    from rclpy.context import Context
    from rclpy.qos import QoSProfile

__getattr__ = passed_on(__name__)

POLL_NS = 250_000_000
"""Step in which upstream waits for services and action servers."""


def block_on(future: Future, call: str) -> Any:
    """Block until `future` is done and return its result; some executor has to run in another thread."""
    kernel.wait(
        lambda: future._done,
        None,
        f"{call} waits for an answer, but no executor spins the node in another thread to receive it",
    )
    error = future.exception()
    if error is not None:
        raise error
    return future.result()


class Client:
    """Calls a service; made by `Node.create_client`."""

    def __init__(
        self,
        context: Context,
        client_impl: ClientHandle,
        srv_type: Any,
        srv_name: str,
        qos_profile: QoSProfile,
        callback_group: CallbackGroup,
    ) -> None:
        self.context = context
        self.__client = client_impl
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.qos_profile = qos_profile
        self._pending_requests: dict[int, Future] = {}
        self.callback_group = callback_group
        self._executor_event = False

    def call(self, request: Any) -> Any:
        """Call and block until the response; never returns unless another thread spins the node.

        Raises TypeError: `request` is no Request of this service.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError()
        return block_on(self.call_async(request), f"client.call() of {self.srv_name!r}")

    def call_async(self, request: Any) -> Future:
        """Send a request; the future is done once an executor has received the response."""
        if not isinstance(request, self.srv_type.Request):
            raise TypeError()
        self.__client.require()
        sequence = self.__client.send_request(request)
        if sequence in self._pending_requests:
            raise RuntimeError(f"Sequence ({sequence}) conflicts with pending request")
        future = Future()
        self._pending_requests[sequence] = future
        future.add_done_callback(self.remove_pending_request)
        return future

    def get_pending_request(self, sequence_number: int) -> Future:
        """Return the future of a request under way; KeyError when there is none."""
        return self._pending_requests[sequence_number]

    def remove_pending_request(self, future: Future) -> None:
        """Forget a request: its response will be ignored."""
        for sequence, pending in self._pending_requests.items():
            if pending is future:
                del self._pending_requests[sequence]
                break

    def service_is_ready(self) -> bool:
        """Whether a server of this service exists."""
        self.__client.require()
        return self.__client.service_server_is_available()

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait in steps of 0.25 s until a server exists; whether one does at the end."""
        left_s = float("inf") if timeout_sec is None else timeout_sec
        while self.context.ok() and not self.service_is_ready() and left_s > 0.0:
            kernel.sleep_ns(POLL_NS)
            left_s -= POLL_NS / 1e9
        return self.service_is_ready()

    @property
    def handle(self) -> ClientHandle:
        return self.__client

    def destroy(self) -> None:
        """Destroy the handle; `Node.destroy_client` does it."""
        self.__client.destroy_when_not_in_use()
