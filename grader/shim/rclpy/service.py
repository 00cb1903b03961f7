"""Services."""

from __future__ import annotations

from rclpy._forwarding import passed_on
from rclpy._rcl.service_endpoints import RequestId, ServiceInfo

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from rclpy._rcl.service_endpoints import ServiceHandle
    from rclpy.callback_groups import CallbackGroup
    from rclpy.qos import QoSProfile

__getattr__ = passed_on(__name__)


class Service:
    """Answers requests; made by `Node.create_service`."""

    def __init__(
        self,
        service_impl: ServiceHandle,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
    ) -> None:
        self.__service = service_impl
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.callback = callback
        self.callback_group = callback_group
        self._executor_event = False
        self.qos_profile = qos_profile

    def send_response(self, response: Any, header: Any) -> None:
        """Answer the request that came with `header`; TypeError unless `response` is a Response."""
        if not isinstance(response, self.srv_type.Response):
            raise TypeError()
        self.__service.require()
        if isinstance(header, ServiceInfo):
            header = header.request_id
        if not isinstance(header, RequestId):
            raise TypeError()
        self.__service.service_send_response(response, header)

    @property
    def handle(self) -> ServiceHandle:
        return self.__service

    def destroy(self) -> None:
        """Destroy the handle; `Node.destroy_service` does it."""
        self.__service.destroy_when_not_in_use()
