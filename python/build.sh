#!/usr/bin/env bash
# Builds the wheel and the sdist of the Python package into the folder given, or python/dist.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
out="${1:-dist}"
python3 -m pip install --quiet "maturin>=1.9,<2"
python3 -m maturin build --profile wheel --locked --out "$out"
python3 -m maturin sdist --out "$out"
ls -l "$out"
