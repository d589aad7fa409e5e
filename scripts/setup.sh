# Sourced by the other scripts: installs what is missing, configures and builds a preset. Nothing is downloaded when all
# is there.

cd "$(dirname "${BASH_SOURCE[0]}")/.."

# What a build needs; `scripts/test --full` adds the fuzzers' compiler.
packages=(
  g++ cmake ninja-build ccache git
  libeigen3-dev libboost-dev libprotobuf-dev protobuf-compiler libspdlog-dev nlohmann-json3-dev libcli11-dev
  libtomlplusplus-dev libmuparser-dev libnats-dev libsqlite3-dev zlib1g-dev libzstd-dev libsodium-dev libhwy-dev libtinygltf-dev libpugixml-dev libsystemd-dev libgtest-dev libgmock-dev libgmp-dev iproute2
)
# What scripts/package needs besides.
packaging_packages=(debhelper dh-python dpkg-dev fakeroot lintian patchelf pkgconf pybind11-dev python3 python3-dev python3-numpy scdoc)

missing_of() {
  local package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || echo "$package"
  done
}

install_missing() {
  local missing
  mapfile -t missing < <(missing_of "$@")
  [ ${#missing[@]} -eq 0 ] && return
  echo "installing ${missing[*]}" >&2
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "error: run as root, or install sudo: these packages are missing: ${missing[*]}" >&2; exit 3; }
    root=(sudo)
  fi
  "${root[@]}" apt-get update -qq >&2
  DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-remove "${missing[@]}" >&2 || {
    echo "error: apt-get could not install ${missing[*]}; see above" >&2
    exit 3
  }
}

# install_server PACKAGE SERVICE...: a package whose tests start daemons of their own. Services that come by this, and
# would run beside those, are turned off; those that were there before are somebody's.
install_server() {
  local package=$1 service services=() root=()
  shift
  [ -n "$(missing_of "$package")" ] || return 0
  for service in "$@"; do systemctl cat "$service" >/dev/null 2>&1 || services+=("$service"); done
  install_missing "$package"
  [ -d /run/systemd/system ] || return 0
  [ "$(id -u)" -eq 0 ] || root=(sudo)
  for service in "${services[@]}"; do "${root[@]}" systemctl disable --now "$service" >&2; done
}
install_slurm() { install_server munge munge; install_server slurm-wlm slurmctld slurmd; }
install_nats_server() { install_missing openssl; install_server nats-server nats-server; }

# configure PRESET [CMAKE_ARGUMENT...]: quiet when all is well.
configure() {
  local log=build/configure-$1.log
  mkdir -p build
  cmake --preset "$@" >"$log" 2>&1 || { cat "$log" >&2; exit 3; }
}

# build PRESET TARGET [CMAKE_ARGUMENT...]: configures where need be; quiet when all is up to date.
build() {
  local preset=$1 target=$2
  shift 2
  if [ ! -f "build/$preset/build.ninja" ] || [ $# -gt 0 ]; then configure "$preset" "$@"; fi
  cmake --build "build/$preset" --target "$target" | sed -u "/no work to do/d" >&2
}
