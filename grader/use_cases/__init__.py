"""What people do with the grader: the floor between the doors (HTTP, pages, commands) and the store.

A use case is a function that does one thing a person wants: hand in, read a grading, grade again, judge. It looks
like this (`grader.use_cases.handing_in` is a short example):

- It takes `Services` first, then the `Caller` who asks, then plain values and contracts: a file's name and bytes,
  never a request or a form.
- It decides by itself whether the caller may do this. A door that forgets to ask opens nothing. "For staff." in a
  docstring means that all others are refused (`forbidden`), "of a course" that there must be one (`no_course`).
- It returns contracts. How they look as JSON or on a page is the door's business.
- It refuses by raising `grader.contracts.errors.RefusedError` with a stable code. `grader.service.routes.problems`
  turns the code into a status, a title, advice and headers; pages show the same title and advice.

So nothing here imports fastapi, starlette or jinja2, and a third door needs no HTTP (import-linter holds both).

`services` is the bundle that every use case gets. `callers` says who asks and how often they may, `visibility`
what of a grading they may see, `following` where a submission stands. The course's are `rules`, `judging`,
`regrading`, `gradebook`, `dashboard` and `people`.
"""
