"""Wait until the service in this container is ready; print the instant."""

import time
import urllib.request

while True:
    try:
        urllib.request.urlopen("http://127.0.0.1:8080/healthz", timeout=60.0)
        break
    except OSError:
        time.sleep(0.01)
print(time.time())
