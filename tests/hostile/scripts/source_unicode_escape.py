# coding: unicode_escape
"""Attack: code hidden behind an encoding that no text scan sees.

Expected: finished
"""
print("held: it still runs in the jail")
#\u000aattempt("hidden", __import__("os").fork)
