"""Putting the pages on the application."""

from fastapi import FastAPI

from grader.service.web import (
    appeals,
    classroom,
    course_pages,
    entrance,
    errors,
    gradebook_page,
    gradings,
    guide,
    judging,
    notices,
    own_pages,
    people_pages,
    picking,
    platforms,
    playground,
    practice,
    receipt_pages,
    registering,
    regrading,
    rubric_pages,
    rule_pages,
    rules_at_once,
    rules_of_section,
    signing_in,
    similar_pages,
    student,
    submission,
    team_pages,
)
from grader.service.web.static_files import StaticFiles

ROUTERS = (
    student.router,
    student.uploads,
    playground.router,
    practice.router,
    practice.runs,
    submission.router,
    entrance.router,
    signing_in.router,
    picking.router,
    registering.router,
    platforms.router,
    platforms.desk,
    notices.router,
    guide.router,
    guide.for_staff,
    classroom.router,
    gradings.router,
    gradebook_page.router,
    judging.router,
    appeals.router,
    appeals.of_submission,
    regrading.router,
    rule_pages.router,
    rules_of_section.router,
    rule_pages.course_router,
    rules_at_once.router,
    team_pages.router,
    team_pages.own,
    receipt_pages.router,
    people_pages.router,
    course_pages.router,
    own_pages.router,
    rubric_pages.router,
    similar_pages.router,
)


def install(app: FastAPI) -> None:
    """Add all pages to `app`; its handlers of failures must stand already."""
    for router in ROUTERS:
        app.router.routes.extend(router.routes)  # each is whole: see `grader.api`
    app.mount("/static", StaticFiles(), name="static")
    errors.install(app)
