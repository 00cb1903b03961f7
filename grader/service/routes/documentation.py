"""The OpenAPI document: FastAPI's, with the shape of problem documents in it."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from grader import __version__
from grader.service.routes.problems import Problem

TITLE = "grader"
TAGS = [
    {"name": "submissions", "description": "Upload a script and ask how it went."},
    {"name": "practice", "description": "Run a script: nothing counts, nothing is kept."},
    {"name": "recordings", "description": "What the car did."},
    {"name": "assignments", "description": "What is asked and how it earns points."},
    {"name": "rules", "description": "Dates, limits and what lateness costs."},
    {"name": "regrades", "description": "Grading again: on trial, then applied or discarded."},
    {"name": "dashboard", "description": "The class at a glance; for instructors."},
    {"name": "gradebook", "description": "Grades for other systems."},
    {"name": "people", "description": "Who one is, who is in the course, what was changed."},
    {"name": "problems", "description": "What went wrong and what to do about it."},
    {"name": "health", "description": "Whether the service can do its work."},
]
DESCRIPTION = (
    "Grades rclpy scripts of an introductory ROS 2 course: each runs unmodified in a sandbox and in virtual "
    "time, drives a simulated car, and is judged by what the car did. Upload a file, follow Location until "
    "`status` is `graded`. Every failure is a problem document (RFC 9457). Instants are UTC (ISO 8601). "
    "Texts are in Chinese or English: `?lang=`, else Accept-Language."
)


def install(app: FastAPI) -> None:
    """Make `app` describe itself completely at /openapi.json."""

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _document(app)
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]  # the way FastAPI documents


def _document(app: FastAPI) -> dict[str, Any]:
    document = get_openapi(
        title=TITLE, version=__version__, description=DESCRIPTION, routes=app.routes, tags=TAGS
    )
    problem = Problem.model_json_schema(ref_template="#/components/schemas/{model}")
    schemas = document.setdefault("components", {}).setdefault("schemas", {})
    schemas.update(problem.pop("$defs", {}))
    schemas["Problem"] = problem
    return document
