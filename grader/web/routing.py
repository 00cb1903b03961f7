"""Putting the pages on the application."""

from fastapi import FastAPI
from fastapi.staticfiles import StaticFiles

from grader.web import classroom, entrance, errors, student, submission
from grader.web.pages import FOLDER


def install(app: FastAPI) -> None:
    """Add all pages to `app`; its handlers of failures must stand already."""
    for router in (student.router, student.uploads, submission.router, entrance.router, classroom.router):
        app.include_router(router)
    app.mount("/static", StaticFiles(directory=FOLDER / "static"), name="static")
    errors.install(app)
