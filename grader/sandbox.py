"""The sandbox's public face: run one script under limits, confined, with a channel to its episode.

One `Sandbox` per grading process; one `Jail` per run: send START, `receive` frames until None, then `close`
for the `JailReport`. What is allowed stands in `grader.jail.policy`; `grader.jail.doctor` tells what a host
offers.
"""

from grader.jail.box import Proof, Sandbox
from grader.jail.jail import Jail
from grader.jail.layers import Layer, Mode
from grader.jail.report import JailReport, Verdict

__all__ = ["Jail", "JailReport", "Layer", "Mode", "Proof", "Sandbox", "Verdict"]
