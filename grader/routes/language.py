"""Which language a request wants: ``?lang=`` first, then ``Accept-Language``, then the service's default."""

from typing import Annotated

from fastapi import Header, Query, Request

from grader.contracts.numerals import decimal
from grader.contracts.text import LANGUAGES, Language

_LONGEST_HEADER = 1_000


async def requested_language(  # on the event loop: what is no coroutine waits for a thread
    request: Request,
    lang: Annotated[
        Language | None, Query(description="Language of texts; goes before Accept-Language.")
    ] = None,
    accept_language: Annotated[
        str | None, Header(description="As browsers send it, e.g. `zh-CN,zh;q=0.9,en;q=0.8`.")
    ] = None,
) -> Language:
    """Return the language to answer in; a dependency of every endpoint that answers with text."""
    default: Language = request.app.state.default_language
    return lang or preferred(accept_language or "", default)


def language_of(request: Request) -> Language:
    """Return the language for an answer to a request that may itself be wrong."""
    asked = request.query_params.get("lang")
    for language in LANGUAGES:
        if asked == language:
            return language
    return preferred(request.headers.get("accept-language", ""), request.app.state.default_language)


def preferred(accept_language: str, default: Language) -> Language:
    """Return the language that the header `accept_language` weighs most; `default` if it names neither."""
    best, best_weight = default, 0.0
    for entry in accept_language[:_LONGEST_HEADER].split(","):
        tag, _, parameters = entry.strip().partition(";")
        primary, weight = tag.strip().lower().split("-")[0], _weight(parameters)
        for language in LANGUAGES:
            if primary == language and weight > best_weight:
                best, best_weight = language, weight
    return best


def _weight(parameters: str) -> float:
    name, _, value = parameters.strip().partition("=")
    if name.strip() != "q":
        return 1.0
    try:
        return decimal(value.strip())
    except ValueError:
        return 0.0
