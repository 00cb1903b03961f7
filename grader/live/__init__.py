"""Cars that people drive in real time, each in a process of its own, behind websockets.

Nothing here is graded, and nothing is kept: real time is not the same twice.
"""
