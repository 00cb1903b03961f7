"""Requests that an assignment sends to the script's own services, as `ros2 service call` would."""

from grader.contracts.assignment import InterfaceDefinition, ServiceCall
from grader.contracts.errors import AssignmentError, ProtocolError
from grader.contracts.outcome import ServiceResult
from grader.sim.cdr import decode, encode
from grader.sim.frames import REQUEST_EVENT, Event, Response
from grader.sim.interfaces import WORLD, Types, with_interfaces
from grader.sim.script_graph import ScriptGraph


class ServiceCalls:
    """The calls of one episode; sequence numbers are their places in the list, from 1.

    Raises:
        AssignmentError: a call has an unknown type or values that do not fit it.
    """

    def __init__(
        self,
        calls: tuple[ServiceCall, ...],
        graph: ScriptGraph,
        interfaces: tuple[InterfaceDefinition, ...] = (),
    ) -> None:
        self._types = with_interfaces(interfaces) if calls else WORLD
        self._results = [ServiceResult(call=call) for call in calls]
        self._requests = [_request(call, self._types) for call in calls]
        self._graph = graph

    @property
    def results(self) -> tuple[ServiceResult, ...]:
        """One result for each call, in the assignment's order."""
        return tuple(self._results)

    def next_ns(self) -> int | None:
        """Return when the next call can be sent, None while no service for one exists."""
        return min((result.call.at_ns for result, _ in self._ready()), default=None)

    def due(self, t_ns: int) -> list[Event]:
        """Return the requests to send at `t_ns`."""
        events = []
        for result, identity in self._ready():
            if result.call.at_ns <= t_ns:
                index = self._results.index(result)
                self._results[index] = ServiceResult(call=result.call, sent_ns=t_ns)
                events.append(Event(REQUEST_EVENT, identity, index + 1, t_ns, self._requests[index]))
        return events

    def answer(self, response: Response) -> None:
        """Take the script's response.

        Raises:
            ProtocolError: it was not asked, has answered already, or the response cannot be read.
        """
        index = response.sequence - 1
        if not 0 <= index < len(self._results):
            raise ProtocolError(f"RESPONSE.sequence {response.sequence} was never asked")
        result = self._results[index]
        if result.sent_ns is None or result.answered_ns is not None:
            raise ProtocolError(f"RESPONSE.sequence {response.sequence} is not awaited")
        self._results[index] = ServiceResult(
            call=result.call,
            sent_ns=result.sent_ns,
            answered_ns=response.t_ns,
            values=decode(f"{result.call.type}_Response", response.payload, self._types),
        )

    def _ready(self) -> list[tuple[ServiceResult, int]]:
        """Return the calls not yet sent whose service exists, with its id."""
        ready = []
        for result in self._results:
            if result.sent_ns is None:
                identity = self._graph.service(result.call.service, result.call.type)
                if identity is not None:
                    ready.append((result, identity))
        return ready


def _request(call: ServiceCall, types: Types) -> bytes:
    try:
        return encode(f"{call.type}_Request", call.values, types)
    except ProtocolError as error:
        raise AssignmentError(f"call of {call.service}: {error}") from None
