"""Attack: burn CPU inside one long call of the C library, where no Python code runs.

Expected: cpu_limit
"""

pow(7, 10**9)
