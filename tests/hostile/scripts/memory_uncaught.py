"""Attack: grow without end and let the MemoryError go.

Expected: raised
"""

kept = []
while True:
    kept.append('x' * (1 << 20))
