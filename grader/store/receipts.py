"""The key that signs receipts: made once, and in every backup from then on."""

import secrets

from grader.store.database import StorePart, add_once
from grader.store.tables import ReceiptKeyRow

_ONLY = 1
_KEY_BYTES = 32


class Receipts(StorePart):
    """Keeps the key; safe to share between threads."""

    def key(self) -> bytes | None:
        """Return the key; None: no receipt was ever given."""
        row = self._get(ReceiptKeyRow, _ONLY)
        return None if row is None else row.secret

    def key_to_sign(self) -> bytes:
        """Return the key, which is made when the first receipt is given."""
        key = self.key()
        if key is None:
            with self._database.writing() as session:
                add_once(
                    session.connection(), ReceiptKeyRow, id=_ONLY, secret=secrets.token_bytes(_KEY_BYTES)
                )
                return session.get_one(ReceiptKeyRow, _ONLY).secret
        return key
