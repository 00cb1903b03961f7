"""Attack: grow without end in small pieces.

Expected: finished
"""

def grow():
    kept = []
    while True:
        kept.append(bytearray(1 << 20))

attempt("grow", grow)
