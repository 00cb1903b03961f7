"""A running service and its workers: what answers HTTP, what draws pages, what grades, and what starts all of it.

`routes` (HTTP resources) and `web` (pages) translate between requests and use cases and decide nothing by
themselves. `worker` claims submissions and has them graded. `composition` builds each of them from the settings.
`grader.api` is the application that a web server loads.
"""
