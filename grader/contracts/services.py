"""Requests that an assignment sends to the script's own services, and what became of them."""

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from grader.contracts.record import record

Scalar = float | int | str | bool


@record
class ServiceCall:
    """A request due at `at_ns`, or as soon after as the script offers the service.

    Attributes:
        type: of the service, e.g. ``std_srvs/srv/Trigger``.
        values: fields of the request; the others have their defaults.
    """

    at_ns: int
    service: str
    type: str
    values: dict[str, Scalar] = field(default_factory=dict)


@record
class ServiceResult:
    """What became of a call.

    Attributes:
        sent_ns: when the script was asked; None: it never offered the service.
        answered_ns: when it answered; None: it never did.
        values: the response as nested fields.
    """

    call: ServiceCall
    sent_ns: int | None = None
    answered_ns: int | None = None
    values: Mapping[str, Any] | None = None
