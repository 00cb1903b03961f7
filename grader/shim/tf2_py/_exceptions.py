"""The exceptions of tf2. Their module is called ``tf2``, as the C module names them in tracebacks."""


class TransformException(Exception):
    """A transform could not be found."""

    __module__ = "tf2"


class ConnectivityException(TransformException):
    """Two frames are not part of the same tree."""

    __module__ = "tf2"


class LookupException(TransformException):
    """A frame does not exist."""

    __module__ = "tf2"


class ExtrapolationException(TransformException):
    """A time lies outside what is known of a frame."""

    __module__ = "tf2"


class InvalidArgumentException(TransformException):
    """A frame name is empty or begins with a slash."""

    __module__ = "tf2"


class TimeoutException(TransformException):
    """A transform did not arrive in time."""

    __module__ = "tf2"
