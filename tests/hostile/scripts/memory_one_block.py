"""Attack: ask for more memory than there is, at once.

Expected: finished
"""

attempt('one block', bytearray, 1 << 40)
attempt('the budget and more', bytearray, 300 << 20)
