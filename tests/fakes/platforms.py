"""A learning platform as an instructor adds it to a course."""

from typing import Any

from grader.contracts.platform import NewPlatform

PLATFORM_ID, PLATFORM_CLIENT = "https://moodle.example.edu", "client-1"


def new_platform(**changed: Any) -> NewPlatform:
    """Return Moodle with other values for some of its fields."""
    fields = {
        "title": "Moodle",
        "issuer": PLATFORM_ID,
        "client_id": PLATFORM_CLIENT,
        "deployment": "1",
        "login_url": f"{PLATFORM_ID}/mod/lti/auth.php",
        "token_url": f"{PLATFORM_ID}/mod/lti/token.php",
        "keys_url": f"{PLATFORM_ID}/mod/lti/certs.php",
    }
    return NewPlatform(**{**fields, **changed})
