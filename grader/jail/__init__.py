"""Parts of the sandbox: policy, confinement, zygote, supervision, probes.

The zygote imports these modules as the stand-alone package ``jail``, without the rest of the grader, so
modules of this package that run on the zygote's side import nothing but the standard library and each other.
"""
