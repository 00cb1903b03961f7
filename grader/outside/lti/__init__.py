"""The service as a tool of a learning platform: LTI 1.3 (1EdTech, "LTI Core 1.3" and "Security Framework 1.0").

A platform sends a browser with a signed message that says who it is and which activity was opened. As with every
other provider of sign-in, the message names a person, and the class list says who that is in the course.
"""

from grader.outside.lti.launch import Kept, Launch, Launches, deployment_in, login_address

__all__ = ("Kept", "Launch", "Launches", "deployment_in", "login_address")
