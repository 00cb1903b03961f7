"""Settings of all tests."""

from hypothesis import settings

# The same examples every time, and no deadline: a loaded machine must not fail a test.
settings.register_profile("project", deadline=None, derandomize=True)
settings.load_profile("project")
