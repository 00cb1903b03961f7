"""Internals that upstream keeps here."""
