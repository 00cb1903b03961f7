"""The process of one run: started by the sandbox, it runs the script and reports how it ended.

`warm` is imported ahead, in the process that all runs are forked from; `runner.run` and `syntax.run` are the
entry points. Scripts cannot tell that any of this is there.
"""
