"""The worker: claims submissions, has them graded in child processes, stores the reports.

One thread per slot supervises one grading process, so a crash of the physics is one retry and nothing more;
one more thread, the heart, renews leases while the slots are busy, mends what crashed workers left, and says
how this worker is; another one examines what instructors upload. Killed at any moment, a worker loses nothing: its
claims end with their leases.
"""

from grader.service.worker.examiner import Uploads
from grader.service.worker.slots import SandboxHealth, WorkerParts, WorkerSlot
from grader.service.worker.worker import Worker, WorkerConfig

__all__ = ["SandboxHealth", "Uploads", "Worker", "WorkerConfig", "WorkerParts", "WorkerSlot"]
