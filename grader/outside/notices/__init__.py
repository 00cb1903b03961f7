"""Sending notices: by the webhooks of group bots, and by e-mail."""

from typing import Final, Literal

Failure = Literal["unreachable", "address", "security", "too_often", "recipient", "refused"]
"""``address``: there is no such bot; ``security``: the signature, or what else the bot checks, is wrong;
``recipient``: this one person's address; ``refused``: whatever else the other side said."""

OFTEN_PAUSE_S: Final = 600.0
"""How long nothing is sent after `too_often`: DingTalk takes nothing for so long."""


class NotSentError(Exception):
    """A notice was not taken.

    Attributes:
        code: why, in a word. detail: why, as the other side said it; never has an address or a secret.
    """

    def __init__(self, code: Failure, detail: str) -> None:
        super().__init__(f"{code}: {detail}")
        self.code: Failure = code
        self.detail = detail

    @property
    def is_persons(self) -> bool:
        """Whether others can be told the same way nevertheless."""
        return self.code == "recipient"
