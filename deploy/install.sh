#!/bin/sh
# Installs AFF Runtime as a service. Run again to update: settings and records stay.
#
#   sudo deploy/install.sh [--dry-run] [--can] [--prefix DIR] [--python PYTHON]
#
# --dry-run   say what would be done, do nothing
# --can       CAN, CANopen or a serial line: their packages, and the service's right to use them
# --prefix    put everything below DIR; no user, no systemd (for tests and packages)
# --python    interpreter of the environment (3.11 to 3.13; default python3)
set -eu
# As root no Python takes modules from the folder in which somebody happens to stand.
export PYTHONSAFEPATH=1

dry_run=no
can=no
prefix=
python=python3
while [ $# -gt 0 ]; do
    case $1 in
        --dry-run) dry_run=yes ;;
        --can) can=yes ;;
        --prefix) prefix=$2; shift ;;
        --python) python=$2; shift ;;
        -h | --help) sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
        *) echo "install.sh: unknown option $1" >&2; exit 2 ;;
    esac
    shift
done

source_dir=$(cd "$(dirname "$0")/.." && pwd)
opt=$prefix/opt/aff-runtime
etc=$prefix/etc/aff-runtime
state=$prefix/var/lib/aff-runtime
units=$prefix/etc/systemd/system
rules=$prefix/etc/udev/rules.d

run() {
    echo "+ $*"
    [ "$dry_run" = yes ] || "$@"
}

if [ -z "$prefix" ] && [ "$dry_run" = no ] && [ "$(id -u)" -ne 0 ]; then
    echo "install.sh: needs root; or use --prefix DIR, or --dry-run" >&2
    exit 2
fi
if ! "$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))'; then
    echo "install.sh: $python is not Python 3.11 to 3.13; name one with --python" >&2
    exit 2
fi

if [ -z "$prefix" ]; then
    if ! getent passwd aff-runtime > /dev/null; then
        run useradd --system --user-group --home-dir /var/lib/aff-runtime \
            --shell /usr/sbin/nologin aff-runtime
    fi
fi

run mkdir -p "$opt/share" "$etc" "$state/learned" "$state/runs" "$units" "$rules"
[ -x "$opt/venv/bin/python" ] || run "$python" -m venv "$opt/venv"
# No extras unless asked: the gateway needs neither numba nor scipy nor matplotlib.
extra=
[ "$can" = no ] || extra="[can]"
run "$opt/venv/bin/python" -m pip install --quiet --no-cache-dir --upgrade "$source_dir$extra"
run cp "$source_dir/deploy/RUNBOOK.md" "$opt/share/RUNBOOK.md"

# The technician's file is never overwritten.
[ -e "$etc/site.yaml" ] || run cp "$source_dir/config/euclid.yaml" "$etc/site.yaml"
[ -e "$etc/learned" ] || [ -L "$etc/learned" ] || run ln -s ../../var/lib/aff-runtime/learned "$etc/learned"

run cp "$source_dir/deploy/aff-runtime.service" "$units/aff-runtime.service"
run mkdir -p "$units/aff-runtime.service.d"
# The technician's file too.
[ -e "$units/aff-runtime.service.d/plc.conf" ] ||
    run cp "$source_dir/deploy/aff-runtime.plc.conf" "$units/aff-runtime.service.d/plc.conf"
# The unit lets programs run from /usr and from the environment: an interpreter elsewhere is named.
base=$("$python" -c 'import sys; print(sys.base_prefix)')
case $base in
    /usr | /usr/*) run rm -f "$units/aff-runtime.service.d/python.conf" ;;
    *)
        echo "+ ExecPaths=$base > $units/aff-runtime.service.d/python.conf"
        [ "$dry_run" = yes ] ||
            printf '[Service]\nExecPaths=%s\n' "$base" > "$units/aff-runtime.service.d/python.conf"
        ;;
esac
if [ "$can" = yes ]; then
    run cp "$source_dir/deploy/aff-runtime.can.conf" "$units/aff-runtime.service.d/can.conf"
fi
run cp "$source_dir/deploy/60-aff-runtime.rules" "$rules/60-aff-runtime.rules"

if [ -z "$prefix" ]; then
    run chown -R aff-runtime:aff-runtime /var/lib/aff-runtime
    run systemctl daemon-reload
    run udevadm control --reload
    run udevadm trigger --name-match=cpu_dma_latency
    run ln -sf /opt/aff-runtime/venv/bin/aff-runtime /usr/local/bin/aff-runtime
fi

cat << DONE
Next: edit $etc/site.yaml, write the PLC's address into
  $units/aff-runtime.service.d/plc.conf (systemctl daemon-reload), then
  aff-runtime check $etc/site.yaml
  systemctl enable --now aff-runtime
  sudo -u aff-runtime aff-runtime status
and follow $opt/share/RUNBOOK.md; the correction stays off until somebody arms it.
After an update: aff-runtime bypass, then systemctl restart aff-runtime.
DONE
