"""Attack: import the grader, its dependencies, and itself from the launcher.

Expected: finished
"""

import importlib
import sys

for name in ("grader", "grader.sandbox", "pydantic", "pybullet", "matplotlib", "fastapi", "pytest", "jail", "jail.zygote", "driver"):
    try:
        importlib.import_module(name)
    except ImportError:
        print("held:", name)
    else:
        print("BREACH: imported", name)
print("BREACH" if any(name.split(".")[0] in ("grader", "jail") for name in sys.modules) else "held: not loaded")
