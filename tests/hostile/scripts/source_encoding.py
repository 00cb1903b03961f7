# -*- coding: no-such-codec -*-
"""Attack: an unknown encoding.

Expected: raised
"""
