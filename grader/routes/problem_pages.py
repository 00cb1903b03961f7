"""What a kind of problem means: the addresses that problem documents carry as their type."""

from typing import Annotated

from fastapi import APIRouter, Path
from pydantic import BaseModel, Field

from grader.contracts.errors import RefusedError
from grader.routes.problem_types import PROBLEM_TYPES
from grader.routes.problems import responses
from grader.routes.submissions import LanguageDep

router = APIRouter(prefix="/api/v1/problems", tags=["problems"])


class ProblemTypeView(BaseModel):
    """One kind of problem."""

    code: str = Field(examples=["not_utf8"])
    status: int = Field(examples=[422])
    title: str = Field(examples=["The file is not UTF-8"])
    fix: str = Field(examples=["Save the file with encoding UTF-8 in the editor."])


@router.get(
    "/{code}", summary="What a problem means", responses=responses("problem_not_found", "invalid_request")
)
def read(
    language: LanguageDep, code: Annotated[str, Path(max_length=64, examples=["not_utf8"])]
) -> ProblemTypeView:
    """Return what a kind of problem means and what to do about it."""
    kind = PROBLEM_TYPES.get(code)
    if kind is None:
        raise RefusedError("problem_not_found", allowed=sorted(PROBLEM_TYPES))
    return ProblemTypeView(
        code=code, status=kind.status, title=kind.title.get(language), fix=kind.fix.get(language)
    )
