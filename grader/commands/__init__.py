"""The commands of `grader`, one module each, imported only when chosen."""
