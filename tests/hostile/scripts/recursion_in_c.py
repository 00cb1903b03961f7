"""Attack: overflow the C stack.

Expected: crashed SIGSEGV
"""

nested = ()
for _ in range(2 * 10**5):
    nested = (nested,)
hash(nested)
