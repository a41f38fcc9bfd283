# Both commands in one image: the simulator `linden` and the benchmark `basu`.
#
#     docker build -t linden .
#     docker run --rm -p 2000-2002:2000-2002 linden
#     docker run --rm -v "$PWD/runs:/home/linden/drives/runs" linden basu run basic
#
# Untried: the project's machines have no Docker daemon. tests/test_dockerfile.py checks what can be checked without one.
FROM python:3.12-slim

RUN useradd --create-home --uid 1000 linden \
    && mkdir -p /home/linden/drives/runs \
    && chown -R linden:linden /home/linden/drives
WORKDIR /src
COPY constraints.txt LICENSE ./
COPY packages ./packages
RUN pip install --no-cache-dir --constraint constraints.txt \
    ./packages/linden ./packages/linden-maps ./packages/basu ./packages/basu-carla-log ./packages/basu-leaderboard \
    && rm -rf /src

# The packages' folder is the root user's: kernels and maps are kept in the user's cache folder, filled here.
USER linden
WORKDIR /home/linden/drives
RUN linden compile

EXPOSE 2000 2001 2002
VOLUME /home/linden/drives/runs
CMD ["linden", "serve", "--host", "0.0.0.0", "--port", "2000"]
