"""Wait until the service in this container is ready and so many workers live; print the instant of readiness."""

import json
import sys
import time
import urllib.request

ready = 0.0
while True:
    try:
        with urllib.request.urlopen("http://127.0.0.1:8080/healthz", timeout=60.0) as answer:
            ready = ready or time.time()
            if len(json.load(answer)["workers"]) == int(sys.argv[1]):
                break
    except OSError:
        pass
    time.sleep(0.01)
print(ready)
