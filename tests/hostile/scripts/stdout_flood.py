"""Attack: print without end.

Expected: output_limit
"""

while True:
    print('x' * 1000)
