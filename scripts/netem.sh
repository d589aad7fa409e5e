# Sourced after setup.sh by what needs a network that delays and loses: install_netem, then exec_with_netem.

netem_packages=(iproute2 tcpdump kmod python3)
repository=$PWD
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)

# The running kernel makes all that peerd/lab/live needs, in a namespace that is gone with the question.
kernel_has_netem() {
  "${as_root[@]}" unshare --net sh -c 'ip link add b type bridge && ip link add v type veth && ip link add i type ifb &&
    tc qdisc add dev v root netem && tc qdisc add dev b clsact &&
    tc filter add dev b egress protocol ip flower src_mac 02:00:00:00:00:01 action mirred egress redirect dev i' 2>/dev/null
}

# Where there can't be netem, says so and ends with 3.
install_netem() {
  install_missing "${netem_packages[@]}"
  kernel_has_netem && return
  if [ "$(uname -m)" != x86_64 ]; then
    echo "error: this kernel has no netem (sch_netem), and User-Mode Linux, which has, is for x86_64" >&2
    exit 3
  fi
  install_missing user-mode-linux
}

# exec_with_netem FOLDER COMMAND...: runs it as root where there is netem, in place of this shell: here, or else in
# User-Mode Linux, where it can write below FOLDER only.
exec_with_netem() {
  local folder=$1
  shift
  if kernel_has_netem; then exec "${as_root[@]}" "$@"; fi
  command -v linux.uml >/dev/null || {
    echo "error: this kernel has no netem (sch_netem), and there is no User-Mode Linux" >&2
    exit 3
  }
  exec "$repository/scripts/uml.sh" "$folder" "$@"
}
