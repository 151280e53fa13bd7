#!/usr/bin/env bash
# rights.sh <hapticd> <config>: without any capability, but with the limits that the unit grants, hapticd gets SCHED_FIFO
# and locked memory; without them it names both rights.
# shellcheck source=../lint/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lint/common.sh"
need setpriv
need prlimit
[ "$(id -u)" -eq 0 ] || skip "only root can start a program as another user"
hapticd=$1 config=$2
nobody=$(id -u nobody)
chmod 755 "$scratch"
install -m 755 "$hapticd" "$scratch/hapticd"
install -m 644 "$config" "$scratch/config.yaml"
mkdir "$scratch/run" && chown nobody "$scratch/run"

# as_nobody <command that runs another>...: the output of a short run by nobody, with no capability but those that
# the command leaves.
as_nobody() {
  "$@" --reuid="$nobody" --regid="$nobody" --clear-groups --no-new-privs "$scratch/hapticd" \
    --config "$scratch/config.yaml" --duration 0.3 --socket "$scratch/run/hapticd.sock" 2>&1 || true
}

as_nobody prlimit --rtprio=0 --memlock=65536 setpriv --bounding-set=-all --inh-caps=-all > "$scratch/refused"
if prlimit --rtprio=95 --memlock=unlimited true 2> /dev/null; then
  as_nobody prlimit --rtprio=95 --memlock=unlimited setpriv --bounding-set=-all --inh-caps=-all > "$scratch/granted"
else
  echo "the limits cannot be raised here: granted by the capabilities SYS_NICE and IPC_LOCK instead"
  as_nobody setpriv --inh-caps=-all,+sys_nice,+ipc_lock --ambient-caps=-all,+sys_nice,+ipc_lock > "$scratch/granted"
fi

# names <output> <right>: the warning about a missing right is there.
names() { grep -qE "$2" "$scratch/$1"; }

grep -q 'SCHED_FIFO' "$scratch/granted" || { cat "$scratch/granted" && fail "nothing about SCHED_FIFO"; }
for right in 'SCHED_FIFO priority' 'mlockall'; do
  names refused "$right" || { cat "$scratch/refused" && fail "$right is missing, and not named"; }
  must_fail "$right, which is granted" names granted "$right"
done
