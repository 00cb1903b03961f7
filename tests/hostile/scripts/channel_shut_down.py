"""Attack: shut the channel down in both directions, then exit.

Expected: finished
"""

import os
import socket

socket.socket(fileno=channel).shutdown(socket.SHUT_RDWR)
print("held: the run has simply ended")
import sys
sys.stdout.flush()
os._exit(0)
