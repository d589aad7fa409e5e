#!/usr/bin/env bash
# tests/collision/hash_everywhere.sh: builds collision_hash with each compiler that is here, without and with all
# optimisation and for each instruction set that this processor has, and compares what is printed with what is written
# in scene_hash.hpp. Exit code 1: an answer depends on the compiler, on its flags or on the machine.
set -euo pipefail
cd "$(dirname "$0")/../.."

has() {  # all of these features
  local feature
  for feature in "$@"; do grep -qw "$feature" /proc/cpuinfo || return 1; done
}
flags=(-O0 -O3)
if [ "$(uname -m)" = x86_64 ]; then
  if has avx2 bmi2 fma; then flags+=("-O3 -march=haswell"); fi
  if has avx512f avx512bw avx512cd avx512dq avx512vl; then flags+=("-O3 -march=x86-64-v4"); fi
  flags+=("-O3 -march=native")
fi

status=0
for compiler in g++ clang++-19; do
  if ! command -v "$compiler" >/dev/null; then
    echo "$compiler is not here: skipped"
    continue
  fi
  for flag in "${flags[@]}"; do
    name=$compiler${flag// /}
    folder=build/hash/$name
    mkdir -p "$folder"
    if ! { cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE= -DCMAKE_CXX_COMPILER="$compiler" \
      -DCMAKE_CXX_FLAGS="$flag" && cmake --build "$folder" --target collision_hash; } >"$folder/log" 2>&1; then
      cat "$folder/log" >&2
      exit 3
    fi
    printf '%-12s %-42s ' "$compiler" "$flag"
    "$folder/bin/collision_hash" || { echo "  DIFFERS from scene_hash.hpp"; status=1; }
  done
done
exit "$status"
