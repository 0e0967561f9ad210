#!/usr/bin/env bash
# What a newcomer gets: the source distribution, a wheel made of it, installed in an environment
# of its own and run away from the sources.
set -euo pipefail
cd "$(dirname "$0")/.."
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT

python -m hatchling build -t sdist -d "$room/sdist"
python -m pip wheel --quiet --no-deps --wheel-dir "$room/wheel" "$room"/sdist/*.tar.gz
python3 -m venv "$room/venv"
"$room/venv/bin/pip" install --quiet "$room"/wheel/*.whl
cd "$room"
PYTHONPATH='' venv/bin/beliefnest --version
PYTHONPATH='' venv/bin/beliefnest run sally-anne --out run
