"""Versions of the schema, applied by `grader.store.schema.migrate`."""
