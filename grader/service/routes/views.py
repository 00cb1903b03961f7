"""What answers show of contracts."""

from typing import Any

from pydantic import BaseModel

from grader.contracts.python import Self


class View(BaseModel):
    """What an answer shows: its fields are the contract's of the same names, or made for it."""

    @classmethod
    def of(cls, shown: object, /, **others: Any) -> Self:
        """Return what is shown of a contract; `others` are the fields that it lacks or has in another form."""
        if not others:
            return cls.model_validate(shown, from_attributes=True)
        same = {name: getattr(shown, name) for name in cls.model_fields if name not in others}
        return cls.model_validate({**same, **others}, from_attributes=True)
