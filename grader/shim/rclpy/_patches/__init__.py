"""The standard library as a script sees it: virtual time, a repeatable host, the run's own files.

`install` puts the replacements in place; each of the other modules holds those for the module it is named after.
"""
