"""Workers on other machines, on PostgreSQL: jobs of Procrastinate carry the news of an upload to one of them.

An upload defers a job in its own transaction, and the worker that takes the job looks at the rows. A job names no
row: rows change places, and they alone decide who is graded next. So nothing that matters is kept here. Slots look
by themselves, too, twice a second; that finds what no job told of: its pause is over, a worker that was busy took
the job, the tables were emptied. This package is imported on PostgreSQL only.
"""
