"""Recognise what probably happened, from the outcome, the commands and the motion.

`script`: how the script ended. `commands`: what it sent to the car. The other modules: what the motion of
one kind of check looks like. Every code has a text ``mistake.<code>`` in the catalogs and an attempt in
``assignments/*/wrong`` that shows it.
"""
