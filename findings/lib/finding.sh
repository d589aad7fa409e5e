# What the findings share: a temporary folder that goes with the script, packages in it, and the verdict.
set -euo pipefail

skip() {
  echo "skipped: $1" >&2
  exit 77
}
folder=$(mktemp -d "${TMPDIR:-/tmp}/finding.XXXXXX")
trap 'rm -rf "$folder"' EXIT

# npm_packages NAME@VERSION..
npm_packages() {
  command -v node >/dev/null && command -v npm >/dev/null || skip "there is no node with npm"
  (cd "$folder" && npm init -y >/dev/null && npm install --no-audit --no-fund --silent "$@") >"$folder/npm.log" 2>&1 ||
    skip "npm can't install $*: $(tail -n 1 "$folder/npm.log")"
}

# debian_packages NAME=VERSION..: their files, in $folder/root
debian_packages() {
  command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || skip "this is no Debian"
  (cd "$folder" && apt-get download "$@") >"$folder/apt.log" 2>&1 || skip "apt can't download $*: $(tail -n 1 "$folder/apt.log")"
  for package in "$folder"/*.deb; do dpkg-deb -x "$package" "$folder/root"; done
}

# verdict PROGRAM EXPECTED RECORDED SEEN
verdict() {
  echo "program:  $1"
  echo "expected: $2"
  echo "seen:     $4"
  if [ "$3" = "$4" ]; then return; fi
  echo "recorded: $3"
  echo "It is not as it was when this was written."
  exit 1
}
