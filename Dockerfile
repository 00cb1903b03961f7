# The grading service and its workers, for an ordinary unprivileged container; docs/container.md says how to run it.
# The image holds Python, the libraries it is linked with, the grader, and nothing else: no shell, no package
# manager, no pip. BASE is any image of Debian 12.
ARG BASE=debian:bookworm-slim

FROM ${BASE} AS build
RUN apt-get update \
 && apt-get install --yes --no-install-recommends binutils python3-venv

# What Debian's Python needs at run time, libstdc++ for PyBullet, and process 1. status.d is where vulnerability
# scanners look for the packages of an image without dpkg.
WORKDIR /tmp/system
RUN apt-get download \
        base-files libbz2-1.0 libc6 libcrypt1 libexpat1 libffi8 libgcc-s1 liblzma5 libncursesw6 libpython3.11-minimal \
        libpython3.11-stdlib libreadline8 libsqlite3-0 libssl3 libstdc++6 libtinfo6 libuuid1 media-types \
        python3.11-minimal readline-common tini zlib1g \
 && mkdir -p /rootfs/usr/bin /rootfs/usr/sbin /rootfs/usr/lib /rootfs/usr/lib64 /rootfs/var/lib/dpkg/status.d /rootfs/data \
 && ln -s usr/bin usr/sbin usr/lib usr/lib64 /rootfs/ \
 && for deb in *.deb; do \
        dpkg-deb --extract "$deb" /rootfs \
     && dpkg-deb --field "$deb" > "/rootfs/var/lib/dpkg/status.d/${deb%%_*}" || exit 1; \
    done \
 && cd /rootfs \
 && rm -rf usr/share/man usr/share/locale usr/share/lintian usr/lib/*-linux-gnu/gconv \
 && find usr/share/doc -type f ! -name copyright -delete \
 && python3 -m compileall -q --invalidation-mode unchecked-hash -s /rootfs usr/lib/python3.11 \
 && echo 'grader:x:1000:1000::/data:/usr/sbin/nologin' > etc/passwd \
 && echo 'grader:x:1000:' > etc/group \
 && echo 'hosts: files dns' > etc/nsswitch.conf \
 && chown 1000:1000 data

# Dependencies before the code: they change less often. The environment that is shipped never contains pip.
# Where pip must be told about a package index: --secret id=pip.conf,src=/etc/pip.conf (and id=ca.crt, its certificate).
WORKDIR /src
COPY requirements-build.lock requirements-extras.lock ./
RUN --mount=type=secret,id=pip.conf,target=/etc/pip.conf --mount=type=secret,id=ca.crt,target=/etc/pip-ca.crt \
    python3.11 -m venv /opt/build \
 && python3.11 -m venv --without-pip /opt/grader \
 && /opt/build/bin/pip install --no-cache-dir --require-hashes -r requirements-build.lock \
 && /opt/build/bin/pip --python /opt/grader/bin/python install --no-cache-dir --no-compile --require-hashes \
        -r requirements-extras.lock
# What the grader never opens: PyBullet's environments, examples and GPU renderer, compressors of bags, compilers of
# extensions, test suites, sources and type stubs of compiled modules; and 126 MB of debugging symbols in PyBullet.
RUN cd /opt/grader/lib/python3.11/site-packages \
 && rm -r pybullet_envs pybullet_examples eglRenderer.*.so \
        numpy/f2py numpy/distutils matplotlib/mpl-data/sample_data lz4 zstandard \
 && find . -type d -name tests -prune -exec rm -r {} + \
 && find . -type f '(' -name '*.pyi' -o -name '*.pyx' -o -name '*.pxd' -o -name '*.h' -o -name '*.a' ')' -delete \
 && strip --strip-unneeded pybullet.*.so
COPY pyproject.toml requirements.lock README.md ./
COPY grader grader
COPY assignments assignments
COPY lesson lesson
COPY docs/exercises.md docs/exercises.zh.md docs/instructor.md docs/instructor.zh.md docs/student.md docs/student.zh.md docs/
# Compiled here, because the root is read-only where it runs; a hash in place of a date spares a look at each source.
RUN /opt/build/bin/pip wheel --no-cache-dir --no-deps --no-build-isolation --wheel-dir /tmp/dist . \
 && /opt/build/bin/pip --python /opt/grader/bin/python install --no-compile --no-deps /tmp/dist/grader-*.whl \
 && cd /opt/grader/bin \
 && find . -type f ! -name grader -delete \
 && ./python -m grader.jail.models \
 && ./python -m compileall -q -x '/(assignments|lesson)/' --invalidation-mode unchecked-hash /opt/grader/lib \
 && ./python -c 'from grader.service.web.pages import compile_all; compile_all()'

FROM scratch
LABEL org.opencontainers.image.title="grader" \
      org.opencontainers.image.description="Auto-grader for introductory ROS 2 (rclpy) motion exercises"
COPY --from=build /rootfs /
COPY --from=build /opt/grader /opt/grader
USER 1000:1000
WORKDIR /data
# FORWARDED_ALLOW_IPS: the proxy in front has an address of the engine's choice, and is to be believed that it has TLS.
ENV PATH=/opt/grader/bin:/usr/bin LANG=C.UTF-8 PYTHONDONTWRITEBYTECODE=1 HOME=/data FORWARDED_ALLOW_IPS=*
VOLUME /data
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=5s --start-period=30s \
    CMD ["python", "-c", "import urllib.request as u; u.urlopen('http://127.0.0.1:8080/healthz', timeout=4)"]
# tini hands signals on and reaps what a killed grading process leaves behind; -s: also below another init.
ENTRYPOINT ["tini", "-s", "--", "grader"]
CMD ["serve", "--host", "0.0.0.0"]
