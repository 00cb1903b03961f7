"""Attack: an expression that exhausts the compiler's stack.

Expected: raised
"""

eval('-' * 200000 + '1')
