"""Statements whose answers nobody needs are sent together: one way to the server and back instead of one each."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import Connection

from grader.contracts.errors import InfrastructureError


@contextmanager
def together(connection: Connection) -> Iterator[None]:
    """Send what is executed within at once, and wait for all of it at the end. On SQLite this changes nothing.

    Within, no result may be looked at, not even how many rows a statement changed.

    Raises:
        InfrastructureError: the database does not answer. Other errors of statements come as the driver's.
    """
    if connection.dialect.name == "sqlite":
        yield
        return
    driver, errors = connection.connection.driver_connection, connection.dialect.loaded_dbapi
    assert driver is not None
    try:
        with driver.pipeline():
            yield
    except (errors.OperationalError, errors.InterfaceError, errors.InternalError) as error:
        # the last: such as a transaction that the server ended because it was idle for too long
        reason = " ".join(str(error).split())
        raise InfrastructureError(f"the database does not answer: {reason}") from error
