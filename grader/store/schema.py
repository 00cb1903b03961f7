"""Bringing a database to the schema this version of the grader expects."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.util.exc import CommandError

from grader.contracts.errors import SettingsError
from grader.store.database import Database

_MIGRATIONS = Path(__file__).parent / "migrations"


def migrate(database: Database) -> None:
    """Create or upgrade the tables; harmless when there is nothing to do.

    Raises:
        SettingsError: the database was written by a newer grader.
    """
    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS).replace("%", "%%"))
    with database.engine.begin() as connection:
        config.attributes["connection"] = connection
        try:
            command.upgrade(config, "head")
        except CommandError as error:
            raise SettingsError(f"this database does not fit this version of the grader: {error}") from error
