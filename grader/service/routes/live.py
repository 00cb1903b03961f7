"""A car of one's own in real time, and the websocket to it. The websocket speaks rosbridge v2 (docs/live.md)."""

import asyncio
from datetime import datetime
from http.cookies import CookieError, SimpleCookie

from fastapi import APIRouter, FastAPI, Request, Response, status
from fastapi.concurrency import run_in_threadpool
from pydantic import Field
from starlette.datastructures import Headers
from starlette.routing import WebSocketRoute
from starlette.types import Receive, Scope, Send

from grader.contracts.identity import Caller
from grader.live.connection import is_own_origin, refuse, serve
from grader.service.requests.dependencies import DRAWN, SESSION_COOKIE, ErrandDep
from grader.service.routes.problems import responses
from grader.service.routes.views import View
from grader.use_cases.live import OpenCar, car_behind, car_of, end_car, open_car
from grader.use_cases.services import Services

router = APIRouter(prefix="/api/v1/live", tags=["live"])
_PATH = "/live/{key}"
_PROBLEMS = ("no_course",)


class LiveCarView(View):
    """The caller's car."""

    url: str = Field(
        description="Where rosbridge clients connect. Whoever knows it drives the car: keep it to yourself.",
        examples=["ws://127.0.0.1:8080/live/3q2-7wAAAAAAAAAAAAAAAA/"],
    )
    expires_at: datetime = Field(description="It ends then, or when nobody was connected for `idle_s`.")
    idle_s: float = Field(examples=[120.0])
    clients: int = Field(description="Open connections.", examples=[1])


@router.post(
    "",
    status_code=status.HTTP_201_CREATED,
    summary="Have a car of one's own",
    dependencies=[DRAWN],
    responses=responses(*_PROBLEMS, "live_off", "live_full"),
)
async def have_car(errand: ErrandDep, request: Request) -> LiveCarView:
    """Start a car, or return the one that is there: each person has one."""
    return _view(request, errand.services, await open_car(errand.services, errand.caller, _now_s()))


@router.get("", summary="One's own car", responses=responses(*_PROBLEMS, "live_not_found"))
async def read_car(errand: ErrandDep, request: Request) -> LiveCarView:
    """Return the caller's car and how many are connected to it."""
    return _view(request, errand.services, car_of(errand.services, errand.caller, _now_s()))


@router.delete(
    "", status_code=status.HTTP_204_NO_CONTENT, summary="End one's own car", responses=responses(*_PROBLEMS)
)
async def give_up_car(errand: ErrandDep) -> Response:
    """End the car and all connections to it; its address opens nothing any more."""
    end_car(errand.services, errand.caller)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


def install(app: FastAPI) -> None:
    """Let `app` connect websockets with cars, with and without a slash at the end of the address."""
    for path in (_PATH, f"{_PATH}/"):
        app.router.routes.append(WebSocketRoute(path, _Door()))


class _Door:
    """The websocket of a car, as an ASGI application: refusals are answers of HTTP."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        services: Services = scope["app"].state.services
        if not is_own_origin(scope):
            await refuse(send, 403, "forbidden")
            return
        caller = await run_in_threadpool(_known_caller, services, Headers(scope=scope))
        place = car_behind(services, scope["path_params"]["key"], caller)
        if place is None:
            await refuse(send, 404, "live_not_found")
            return
        await serve(receive, send, place.car)


def _known_caller(services: Services, headers: Headers) -> Caller | None:
    """Return who connects, None of clients that do not say it: what counts then is that they know the address."""
    scheme, _, token = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer" and token:
        return services.callers.identify(token)
    try:
        session = SimpleCookie(headers.get("cookie", "")).get(SESSION_COOKIE)
    except CookieError:
        return None
    return None if session is None else services.callers.of_session(session.value)


def address_of(request: Request, car: OpenCar) -> str:
    """Return where clients connect to a car, on the host that `request` names."""
    scheme = "wss" if request.url.scheme == "https" else "ws"
    return f"{scheme}://{request.url.netloc}{_PATH.format(key=car.key)}/"


def _view(request: Request, services: Services, car: OpenCar) -> LiveCarView:
    return LiveCarView(
        url=address_of(request, car),
        expires_at=car.expires_at,
        idle_s=services.live.idle_s,
        clients=car.clients,
    )


def _now_s() -> float:
    return asyncio.get_running_loop().time()
