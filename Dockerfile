# The grading service in an ordinary unprivileged container (default seccomp profile, no added capabilities).
# Build:  docker build -t grader .
# Run:    docker run --rm --read-only --tmpfs /tmp --init -p 127.0.0.1:8080:8080 -v grader-data:/data \
#             --memory 2g --pids-limit 512 --security-opt no-new-privileges grader
FROM python:3.11-slim-bookworm AS build
WORKDIR /src
COPY requirements.lock requirements-dev.lock ./
RUN python -m venv /opt/grader \
 && /opt/grader/bin/pip install --no-cache-dir --require-hashes -r requirements.lock \
 && python -m venv /opt/build \
 && /opt/build/bin/pip install --no-cache-dir --require-hashes -r requirements-dev.lock
COPY pyproject.toml README.md ./
COPY grader grader
COPY assignments assignments
RUN /opt/build/bin/pip wheel --no-deps --no-build-isolation --wheel-dir /tmp/dist . \
 && /opt/grader/bin/pip install --no-cache-dir --no-deps /tmp/dist/grader-*.whl

FROM python:3.11-slim-bookworm
COPY --from=build /opt/grader /opt/grader
RUN useradd --uid 1000 --create-home --home-dir /data grader
USER 1000
WORKDIR /data
ENV PATH=/opt/grader/bin:$PATH PYTHONDONTWRITEBYTECODE=1
VOLUME /data
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=5s --start-period=20s \
    CMD ["python", "-c", "import urllib.request as u; u.urlopen('http://127.0.0.1:8080/healthz', timeout=4)"]
ENTRYPOINT ["grader"]
CMD ["serve", "--host", "0.0.0.0", "--data", "/data"]
