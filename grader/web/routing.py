"""Putting the pages on the application."""

from fastapi import FastAPI
from fastapi.staticfiles import StaticFiles

from grader.web import classroom, entrance, errors, progress, student, submission
from grader.web.pages import FOLDER


def install(app: FastAPI) -> None:
    """Add all pages to `app`; its handlers of failures must stand already."""
    routers = (student.router, student.uploads, submission.router, progress.router, entrance.router)
    for router in (*routers, classroom.router):
        app.include_router(router)
    app.mount("/static", StaticFiles(directory=FOLDER / "static"), name="static")
    errors.install(app)
