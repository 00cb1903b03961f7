"""Attack: end by an error whose text leaves no memory to report it, as if the script had ended by itself.

Expected: crashed
"""


class Endless(Exception):
    def __str__(self):
        return "x" * (300 << 20)


raise Endless
