"""PyBullet for scripts of the world `pybullet`: the real module, whose calls are recorded and replayed.

Only the process that such scripts are forked from loads it (`warm`). The script meets `module`; another confined
process, forked from the same one, carries out the recorded calls again and tells what became of them (`replay`).
"""
