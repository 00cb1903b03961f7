"""Sending notices: by the webhooks of group bots, and by e-mail."""

from grader.outside.notices.failure import Failure, NotSentError

__all__ = ("Failure", "NotSentError")
