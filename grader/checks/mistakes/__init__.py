"""Recognise what probably happened, from the outcome, the commands and the motion.

`script`: how the script ended (`grader.messages.exceptions`: with which exception). `commands`: what it sent to
the car. The other modules: what the motion of one kind of check looks like. Every code has a text
``mistake.<code>`` in the catalogs, those about motion an attempt in ``assignments/*/wrong`` that shows them.
"""
