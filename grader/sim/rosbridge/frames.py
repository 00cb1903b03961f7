"""The frames that clients send, decoded strictly: one JSON object with a known ``op`` and fields of known types.

Forms and names are those of ROSBRIDGE_PROTOCOL.md in rosbridge_suite and of its ROS 2 branch. A field that an
operation does not know is ignored, as rosbridge does. Sizes are bounded here; depth by the JSON reader and by the
types of messages.
"""

from typing import Annotated, Any, Final, TypeAlias

import msgspec
from msgspec import Meta

from grader.contracts.errors import GraderError

MAX_FRAME_BYTES: Final = 65_536
MAX_FRAGMENTS: Final = 1_000
_LONGEST_MESSAGE: Final = 300

Identity: TypeAlias = Annotated[str, Meta(max_length=256)] | int | float | None
"""A frame's ``id``; it comes back in whatever answers the frame."""

_Name: TypeAlias = Annotated[str, Meta(min_length=1, max_length=256)]
_Type: TypeAlias = Annotated[str, Meta(max_length=256)] | None
_Args: TypeAlias = dict[str, Any] | list[Any] | None
_Milliseconds: TypeAlias = Annotated[float, Meta(ge=0, le=3_600_000)] | None
# roslib sends whole numbers as floats.
_Count: TypeAlias = Annotated[float, Meta(ge=0, le=1_000_000_000)] | None


class FrameError(GraderError):
    """A frame that cannot be taken; the message says what is wrong, for whoever wrote the client."""

    def __init__(self, message: str, identity: Identity = None) -> None:
        super().__init__(message[:_LONGEST_MESSAGE])
        self.id = identity


class Frame(msgspec.Struct, tag_field="op", frozen=True, kw_only=True):
    """Any operation."""

    id: Identity = None


class Advertise(Frame, tag="advertise", frozen=True, kw_only=True):
    """The client is going to publish messages of a type."""

    topic: _Name
    type: _Type = None


class Unadvertise(Frame, tag="unadvertise", frozen=True, kw_only=True):
    """The client will not publish any more."""

    topic: _Name


class PublishFrame(Frame, tag="publish", frozen=True, kw_only=True):
    """A message; fields that it leaves out have their defaults."""

    topic: _Name
    msg: dict[str, Any] = msgspec.field(default_factory=dict)
    type: _Type = None


class Subscribe(Frame, tag="subscribe", frozen=True, kw_only=True):
    """The client wants the messages of a topic, at most one every `throttle_rate` milliseconds."""

    topic: _Name
    type: _Type = None
    throttle_rate: _Milliseconds = None
    queue_length: _Count = None
    fragment_size: _Count = None
    compression: Annotated[str, Meta(max_length=16)] | None = None


class Unsubscribe(Frame, tag="unsubscribe", frozen=True, kw_only=True):
    """The client wants no more of them; without an id, under no id."""

    topic: _Name


class CallService(Frame, tag="call_service", frozen=True, kw_only=True):
    """A request: its fields by name, or in their order."""

    service: _Name
    args: _Args = None
    timeout: Annotated[float, Meta(ge=0, le=3_600)] | None = None


class AdvertiseService(Frame, tag="advertise_service", frozen=True, kw_only=True):
    """The client answers requests to a service."""

    service: _Name
    type: _Type = None


class UnadvertiseService(Frame, tag="unadvertise_service", frozen=True, kw_only=True):
    """The client answers them no longer."""

    service: _Name


class ServiceResponse(Frame, tag="service_response", frozen=True, kw_only=True):
    """The client's answer to a request."""

    service: _Name
    values: Any = None
    result: bool = True


class SendActionGoal(Frame, tag="send_action_goal", frozen=True, kw_only=True):
    """A goal; its result comes back, and its feedback if that is asked for."""

    action: _Name
    action_type: _Type = None
    args: _Args = None
    feedback: bool = False


class CancelActionGoal(Frame, tag="cancel_action_goal", frozen=True, kw_only=True):
    """The client wants the goal that it sent under this id no more."""

    action: _Name


class Fragment(Frame, tag="fragment", frozen=True, kw_only=True):
    """A part of a frame that was too long for the client."""

    data: Annotated[str, Meta(max_length=MAX_FRAME_BYTES)]
    num: Annotated[float, Meta(ge=0, lt=MAX_FRAGMENTS)]
    total: Annotated[float, Meta(ge=1, le=MAX_FRAGMENTS)]


class SetLevel(Frame, tag="set_level", frozen=True, kw_only=True):
    """In the protocol's document; rosbridge of ROS 2 does nothing with it."""


class ClientStatus(Frame, tag="status", frozen=True, kw_only=True):
    """The client says how it is; nobody reads that."""


Incoming: TypeAlias = (
    Advertise
    | Unadvertise
    | PublishFrame
    | Subscribe
    | Unsubscribe
    | CallService
    | AdvertiseService
    | UnadvertiseService
    | ServiceResponse
    | SendActionGoal
    | CancelActionGoal
    | Fragment
    | SetLevel
    | ClientStatus
)

_decoder: Final[msgspec.json.Decoder[Incoming]] = msgspec.json.Decoder(Incoming)


class _OnlyId(msgspec.Struct):
    id: Identity = None


_ids: Final[msgspec.json.Decoder[_OnlyId]] = msgspec.json.Decoder(_OnlyId)


def read_frame(text: str | bytes) -> Incoming:
    """Return the frame of a JSON text.

    Raises:
        FrameError: it is none: too long, no JSON, too deep, an unknown ``op``, a field missing or of a wrong type.
    """
    try:
        if (
            len(text) > MAX_FRAME_BYTES
            or len(text.encode() if isinstance(text, str) else text) > MAX_FRAME_BYTES
        ):
            raise FrameError(f"a frame has at most {MAX_FRAME_BYTES} bytes")
        return _decoder.decode(text)
    except RecursionError:
        raise FrameError("the frame is nested too deeply") from None
    except UnicodeError:
        raise FrameError("the frame is no Unicode text") from None
    except msgspec.ValidationError as error:
        raise FrameError(f"the frame cannot be used: {error}", _id_of(text)) from None
    except msgspec.DecodeError as error:
        raise FrameError(f"the frame is no single JSON object: {error}") from None


def _id_of(text: str | bytes) -> Identity:
    """Return the id of a frame that is wrong otherwise, so that the client finds what was wrong."""
    try:
        return _ids.decode(text).id
    except (msgspec.MsgspecError, RecursionError, UnicodeError):
        return None
