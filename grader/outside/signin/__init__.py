"""Signing in by somebody else's word: a university's OpenID Connect or CAS, or a proxy that has asked already.

A `Provider` sends a browser away to be recognised and turns what it comes back with into a `Person`: the
provider's own name for them, and perhaps the id that they have in a course. Whose session that opens, and in
which role, is decided by the roster alone (`grader.use_cases.signing_in`).
"""

from grader.outside.signin.config import SignInConfig, read_config
from grader.outside.signin.providers import (
    Person,
    Provider,
    Providers,
    SignInAttempt,
    SignInError,
    is_subject,
)

__all__ = (
    "Person",
    "Provider",
    "Providers",
    "SignInAttempt",
    "SignInConfig",
    "SignInError",
    "is_subject",
    "read_config",
)
