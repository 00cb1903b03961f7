"""How Alembic runs here: always on a connection handed over by `grader.store.schema`."""

from alembic import context
from sqlmodel import SQLModel

from grader.store import tables  # noqa: F401  registers the tables in the metadata

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=SQLModel.metadata,
    render_as_batch=True,  # SQLite changes a column by rebuilding its table
)
with context.begin_transaction():
    context.run_migrations()
