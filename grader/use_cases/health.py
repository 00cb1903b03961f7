"""Whether the service does its work: what waits, and who grades it."""

from dataclasses import dataclass

from grader.contracts.submission import QueueState, WorkerState
from grader.use_cases.services import Services


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """The queue, and the workers that were heard of lately."""

    queue: QueueState
    workers: tuple[WorkerState, ...]

    @property
    def ready(self) -> tuple[WorkerState, ...]:
        """Return the workers that grade; while there are none, uploads are only kept."""
        return tuple(one for one in self.workers if one.sandbox_ready and one.slots > 0)


def health_of(services: Services) -> Health:
    """Return the state of the queue and of all workers that are alive."""
    workers = services.workers.alive(services.settings.silent_s)
    return Health(queue=services.queue.state(), workers=workers)
