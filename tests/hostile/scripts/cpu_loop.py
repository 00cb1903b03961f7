"""Attack: burn CPU for ever.

Expected: cpu_limit
"""

while True:
    pass
