"""The playground: a car of one's own in real time, and the assignments that can be tried out."""

import asyncio

from fastapi import APIRouter, Response
from fastapi.responses import JSONResponse

from grader.contracts.errors import RefusedError
from grader.messages import on_page
from grader.operation.logs import note
from grader.service.routes.live import address_of
from grader.service.web.access import COSTLY, DRAWN, KnownDep
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.use_cases.assignments import checklist
from grader.use_cases.live import open_car
from grader.use_cases.practising import may_practise

router = APIRouter(prefix="/playground", include_in_schema=False)
_WORDS = ("starting", "connected", "ended", "lost", "again", "copied", "held", "place")
_SPEEDS_MPS = (0.5, 1, 2)


@router.get("", dependencies=[COSTLY])
def read(errand: KnownDep) -> Response:
    """Show the car's controls, and which assignments have an editor."""
    caller, language = errand.caller, errand.language
    if caller.course is None:
        raise RefusedError("no_course")
    offered = errand.services.practice.offered
    return page(
        errand.request,
        "playground.html",
        assignments=[
            assignment
            for assignment in checklist(errand.services, caller)
            if offered and may_practise(errand.services, caller, assignment)
        ],
        off=None if errand.services.live.most else form_problem(RefusedError("live_off"), language),
        idle_minutes=round(errand.services.live.idle_s / 60),
        life_minutes=round(errand.services.live.life_s / 60),
        speeds=_SPEEDS_MPS,
        words={name: on_page(language, f"playground.{name}") for name in _WORDS},
    )


@router.post("/car", dependencies=[*OWN_FORM, DRAWN])
async def have_car(errand: KnownDep) -> Response:
    """Start the visitor's car, or find the one that is there; answer with its address."""
    headers = {"Cache-Control": "no-store"}
    try:
        car = await open_car(errand.services, errand.caller, asyncio.get_running_loop().time())
    except RefusedError as problem:
        note(code=problem.code)
        told = form_problem(problem, errand.language)
        return JSONResponse({"refused": [told.title, told.fix]}, told.status, headers)
    return JSONResponse({"url": address_of(errand.request, car)}, headers=headers)
