#!/usr/bin/env bash
# What a newcomer gets: the source distribution, a wheel made of it, installed in an environment
# of its own and run away from the sources, with the newest supported Python that this machine has;
# with BELIEFNEST_NIGHTLY=1 with each that it has.
set -euo pipefail
cd "$(dirname "$0")/.."
room=$(mktemp -d)
# A command leaves a process behind that compiles kernels: it writes here until it has ended.
end() {
  pkill -f "$room/" || true
  until rm -rf "$room"; do sleep 1; done
}
trap end EXIT
export PYTHONPATH=''

# Paths of the Pythons from 3.11 on, one of each version, on the PATH or kept by pyenv.
pythons() {
  local minor python
  for minor in 11 12 13 14; do
    for python in "python3.$minor" "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3."$minor".*/bin/python; do
      if "$python" -c "import sys; sys.exit(sys.version_info[:2] != (3, $minor))" 2>/dev/null; then
        echo "$python"
        break
      fi
    done
  done
}

# Install the wheel with one Python and run the README's first command; says all at its end.
visit() {
  local home said
  home=$(mktemp -d -p "$room")
  if said=$( {
    "$1" -m venv --without-pip "$home/venv" &&
      python -m pip --python "$home/venv/bin/python" install --quiet --no-compile "$room"/wheel/*.whl &&
      cd "$home" &&
      export NUMBA_CACHE_DIR="$home/kernels" &&
      venv/bin/beliefnest --version &&
      venv/bin/beliefnest run sally-anne --out run &&
      # The first run compiles its kernels beside, and plays in Python meanwhile: the same results.
      venv/bin/beliefnest run sally-anne --out again >/dev/null &&
      diff -r -x '*.bn' -x '*.json' -x '*.jsonl' -x report.html -x summary.txt run again
  } 2>&1); then
    printf '%s\n%s\n' "$("$1" --version)" "$said"
  else
    printf '%s\n%s\nthe wheel does not work with %s\n' "$("$1" --version)" "$said" "$1" >&2
    return 1
  fi
}

# The builder is in a folder of its own, so that any Python with pip will do.
python -m pip install --quiet --target "$room/builder" "hatchling>=1.27,<2"
PYTHONPATH="$room/builder" python -m hatchling build -t sdist -d "$room/sdist"
python -m pip wheel --quiet --no-deps --wheel-dir "$room/wheel" "$room"/sdist/*.tar.gz
mapfile -t found < <(pythons)
[ "${BELIEFNEST_NIGHTLY:-}" = 1 ] || found=("${found[@]: -1}")
((${#found[@]})) || { echo "no Python from 3.11 on was found" >&2; exit 1; }
export room
export -f visit
printf '%s\n' "${found[@]}" | xargs -P 2 -I{} bash -c 'set -euo pipefail; visit "$1"' visit {}
