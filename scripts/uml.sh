#!/usr/bin/env bash
# scripts/uml.sh FOLDER COMMAND...: runs a command, as root, in User-Mode Linux: a kernel as an ordinary process, whose
# modules hold what the running kernel may lack (Debian's user-mode-linux). The guest sees this computer's files and can
# write to none of them but those below FOLDER. The command's standard output and exit code are this script's; the
# rest is on the standard error output. Ended by a signal, it ends the guest and all that is in it. UML_NUMBER: of several
# guests at once each has its own, and so another processor.
set -euo pipefail
export PATH=/usr/sbin:/usr/bin:/sbin:/bin

if [ "$$" -ne 1 ]; then
  mkdir -p "$1"
  folder=$(realpath "$1")
  shift
  case $folder in
    *[[:space:]]*) echo "error: User-Mode Linux takes no blanks in a folder's name: $folder" >&2; exit 2 ;;
  esac
  messages=$(mktemp -d "$folder/.uml.XXXXXX")
  trap 'rm -rf "$messages"' EXIT
  printf '%q ' cd "$PWD" >"$messages/command"
  printf '\n' >>"$messages/command"
  printf '%q ' "$@" >>"$messages/command"
  # 768 MB: what a dozen peers need. The guest's terminal is this script's standard error output. It has one processor,
  # and its host threads, which hand each system call to and fro, stay on one, too: where each time another one is woken, a
  # call takes 100 us in place of 22.
  allowed=$(taskset -cp "$$")
  mapfile -t processors < <(tr , '\n' <<<"${allowed##* }" | while IFS=- read -r a b; do seq "$a" "${b:-$a}"; done)
  setpriv --pdeathsig TERM taskset -c "${processors[${UML_NUMBER:-0} % ${#processors[@]}]}" \
    linux.uml mem=768M rootfstype=hostfs rootflags=/ ro "init=$(realpath "$0")" \
    "UML_FOLDER=$folder" "UML_MESSAGES=$messages" con=null con0=null,fd:2 con1=null quiet loglevel=0 \
    </dev/null >"$messages/boot" 2>&2 &
  guest=$!
  trap 'kill "$guest" 2>/dev/null; wait "$guest"; exit 3' INT TERM HUP
  wait "$guest" || true
  if [ ! -f "$messages/exit_code" ]; then
    tail -3 "$messages/boot" >&2
    echo "error: User-Mode Linux did not run; see above" >&2
    exit 3
  fi
  cat "$messages/out"
  exit "$(cat "$messages/exit_code")"
fi

# From here on: the guest's first process.
power_off() {
  sync
  python3 -c 'import ctypes; ctypes.CDLL(None).reboot(0x4321fedc)'  # LINUX_REBOOT_CMD_POWER_OFF
}
trap power_off EXIT
mount -t proc none /proc
mount -t sysfs none /sys
mount -t tmpfs none /run
mount -t hostfs none "$UML_FOLDER" -o "$UML_FOLDER"
case $UML_FOLDER in /tmp/*) ;; *) mount -t tmpfs none /tmp ;; esac
mkdir -p /run/kmod/lib
ln -s /usr/lib/uml/modules /run/kmod/lib/modules
modprobe -d /run/kmod -S "$(uname -r)" -a bridge veth ifb sch_netem sch_ingress cls_flower act_mirred
ip link set lo up
code=0
setsid bash "$UML_MESSAGES/command" >"$UML_MESSAGES/out" 2>/dev/console </dev/null || code=$?
echo "$code" >"$UML_MESSAGES/exit_code"
