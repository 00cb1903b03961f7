"""Attack: a regular expression that backtracks for ever.

Expected: cpu_limit
"""

import re

re.match('(a+)+$', 'a' * 64 + 'b')
