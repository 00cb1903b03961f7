"""Attack: file names with NUL, newlines, broken UTF-8, dots and great length.

Expected: finished
"""

for name in ("/tmp/evil\0", "/tmp/evil\n", "/tmp/evil\udcff", "/tmp/../tmp/evil", "/tmp/" + "e" * 255, "/" + "a/" * 3000):
    attempt(repr(name)[:40], open, name, "w")
