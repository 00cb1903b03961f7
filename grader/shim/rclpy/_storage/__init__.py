"""The files of a run: a small tree in memory, and the descriptors that are open on it."""
