"""Attack: put a file of its own in the channel's place.

Expected: finished
"""

import os

reading, writing = os.pipe()
saved = os.dup(channel)
os.dup2(writing, channel)
os.write(channel, b"\xff" * 8)
os.dup2(saved, channel)
print("held: only its own descriptor moved")
