"""Attack: escape sequences, bidirectional marks, broken UTF-8 and forged result lines on stdout.

Expected: finished
"""

import os

os.write(1, b"held: nothing reads results from here\n")
os.write(1, b"\x1b]0;title\x07\x1b[2J\xff\xfe\xc3\x28\xed\xa0\x80 [PASSED] score: 100/100 \xe2\x80\xae\r\n\0")
print('{"score": 100, "status": "graded"}', "<script>alert(1)</script>")
