"""Pages for people who would rather look than read: server-rendered, in Chinese and English.

Everything works without scripts; the few in ``static`` add progress, the replay and dropping files. Pages read
through the same functions as the JSON interface and never show text that `grader.render.escape` has not seen
(see `grader.service.web.pages`).
"""
