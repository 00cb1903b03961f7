"""The memory of the service: submissions, their way through the queue, gradings and what they show.

The submission's row is the truth; whatever carries work around is only a hint that a row is waiting. Speaks
`grader.contracts` outward; rows and SQL stay inside. One database transaction per call.
"""
