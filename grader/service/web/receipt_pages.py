"""The page on which staff checks a receipt."""

from typing import Annotated

from fastapi import APIRouter, Depends, File, Form, Response, UploadFile

from grader.contracts.errors import RefusedError
from grader.contracts.receipt import LONGEST_RECEIPT
from grader.service.web.access import PageErrand, StaffDep, require_staff
from grader.service.web.errors import form_problem
from grader.service.web.forms import OWN_FORM
from grader.service.web.pages import page
from grader.use_cases.handing_in import most_upload_bytes
from grader.use_cases.receipts import CheckedReceipt, check_receipt

router = APIRouter(prefix="/class/receipts", include_in_schema=False, dependencies=[Depends(require_staff)])


@router.get("")
def read(errand: StaffDep) -> Response:
    """Ask for a receipt."""
    return _page(errand)


@router.post("", dependencies=OWN_FORM)
def check(
    errand: StaffDep,
    receipt: Annotated[str, Form(max_length=LONGEST_RECEIPT)] = "",
    file: Annotated[UploadFile | None, File()] = None,
) -> Response:
    """Say whether the service signed a receipt, and whether the file is the one that it is about."""
    content = b"" if file is None else file.file.read(most_upload_bytes(errand.services) + 1)
    try:
        checked = check_receipt(errand.services, errand.caller, receipt, content)
    except RefusedError as problem:
        if problem.code != "false_receipt":
            raise
        return _page(errand, receipt, problem=problem)
    return _page(errand, receipt, checked=checked)


def _page(
    errand: PageErrand,
    text: str = "",
    *,
    checked: CheckedReceipt | None = None,
    problem: RefusedError | None = None,
) -> Response:
    refusal = None if problem is None else form_problem(problem, errand.language)
    status = 200 if refusal is None else refusal.status
    return page(errand.request, "receipts.html", status=status, text=text, checked=checked, refusal=refusal)
