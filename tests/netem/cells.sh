#!/usr/bin/env bash
# cells.sh PEERD FOLDER: anew each time.
set -euo pipefail
rm -rf "$2"
exec "$(dirname "$0")/../../scripts/netem-matrix" --test --program "$1" --out "$2"
