"""The recordings can be read, and are of the scripts that are run beside them."""

import hashlib

from tests.real.recordings import FOLDER, ids, recording


def test_every_recording_can_be_read() -> None:
    recordings = [recording(name) for name in ids()]
    assert len(recordings) == 419
    assert sum(one.poses is not None for one in recordings) == 359
    assert sum(one.interrupted_at_s is not None for one in recordings) == 126


def test_no_script_has_changed_since_it_was_recorded() -> None:
    root = FOLDER.parents[1]
    lines = (FOLDER / "scripts.sha256").read_text("utf-8").splitlines()
    recorded = {path: digest for digest, path in (line.split("  ") for line in lines)}
    run = {str(recording(name).script.relative_to(root)) for name in ids()}
    assert recorded.keys() == run
    for path, digest in recorded.items():
        assert hashlib.sha256((root / path).read_bytes()).hexdigest() == digest, path
