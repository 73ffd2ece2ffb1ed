#!/bin/sh
# Installs AFF Runtime as a service. Run again to update: settings and records stay.
#
#   sudo deploy/install.sh [--dry-run] [--can] [--records] [--hmi [--plant] | --remove-hmi]
#                          [--line NAME] [--prefix DIR] [--python PYTHON]
#                          [--wheels DIR | --unlocked] [--product WHEEL] [--fresh]
#   deploy/install.sh --compare [--prefix DIR]
#
# --dry-run     say what would be done, do nothing
# --can         CAN, CANopen or a serial line: their packages, and the service's right to use them;
#               updated ever after
# --records     Parquet: aff-runtime watch and export; and a timer for the first, which nothing
#               starts; updated ever after
# --hmi         the screen too: a user, an environment and a unit of its own; updated ever after;
#               a key and a certificate where it has none. And the unit of the commissioner, which
#               nothing starts
# --plant       with --hmi: the line model's packages too, so that the commissioner can refine;
#               updated ever after. Without it refine is for another machine
# --remove-hmi  take the screen away again and nothing else; what somebody put into /etc/aff-hmi
#               stays
# --line        one more line on this gateway: a service aff-runtime@NAME with a site file, folders
#               and, while they last, a processor of its own; may stand more than once
# --fresh       new environments in place of those that are there, every package by its hash
# --compare     say which installed files are not as they were installed; exit 1 where some are not
# --prefix      put everything below DIR; no user, no systemd (for tests and packages)
# --python      interpreter of the environment (3.11 to 3.13; default python3)
# --wheels      packages from this folder only, without a network: filled by
#               pip download --require-hashes --only-binary :all: -d DIR -r deploy/locks/....txt
# --unlocked    the newest packages of the ranges in pyproject.toml, unchecked; by itself exactly
#               those of deploy/locks, each compared with its hash when fetched
# --product     this wheel of the same release instead of one built here: the law's binary where
#               no C compiler is (aff-runtime --version: law by compiled, else by numpy)
set -eu
# As root no Python takes modules from the folder in which somebody happens to stand.
export PYTHONSAFEPATH=1
# Whatever root's own is: the service's user reads what is installed, and nobody else writes it.
umask 022

dry_run=no
can=no
records=no
hmi=no
plant=no
wheels=
locked=yes
product=
lines=
fresh=no
compare=no
build=
prefix=
python=python3
while [ $# -gt 0 ]; do
    case $1 in
        --dry-run) dry_run=yes ;;
        --can) can=yes ;;
        --records) records=yes ;;
        --hmi) hmi=yes ;;
        --plant) plant=yes ;;
        --remove-hmi) hmi=remove ;;
        --line)
            case $2 in
                '' | -* | *[!A-Za-z0-9_-]*)
                    echo "install.sh: --line '$2': letters, digits, _ and - only" >&2; exit 2 ;;
            esac
            lines="$lines $2"; shift ;;
        --fresh) fresh=yes ;;
        --compare) compare=yes ;;
        --prefix) prefix=$2; shift ;;
        --python) python=$2; shift ;;
        --wheels) wheels=$2; shift ;;
        --unlocked) locked=no ;;
        --product) product=$2; shift ;;
        -h | --help) sed -n '2,30s/^# \{0,1\}//p' "$0"; exit 0 ;;
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
hmi_opt=$prefix/opt/aff-hmi
hmi_etc=$prefix/etc/aff-hmi

run() {
    echo "+ $*"
    [ "$dry_run" = yes ] || "$@"
}

# A drop-in of one line.
put() {
    echo "+ $2 > $1"
    [ "$dry_run" = yes ] || printf '[Service]\n%s\n' "$2" > "$1"
}

. "$source_dir/deploy/environments.sh"

# The end, whatever it is: what was built goes; an environment that was not replaced comes back.
finish() {
    [ "$build" = /tmp/aff-build ] || rm -rf "$build"
    [ "$dry_run" = no ] || return 0
    for place in "$opt" "$hmi_opt"; do
        if [ -d "$place/venv.before" ]; then
            rm -rf "$place/venv"
            mv "$place/venv.before" "$place/venv"
            echo "install.sh: stopped; the former environment is back in $place/venv" >&2
        fi
    done
}
trap finish EXIT

# The product itself as a wheel, from a copy: the source stays as it is, and what an earlier build
# left in it stays out.
make_wheel() {
    build=/tmp/aff-build
    if [ "$dry_run" = no ]; then
        build=$(mktemp -d)
    fi
    run mkdir -p "$build/source/deploy"
    run cp -r "$source_dir/pyproject.toml" "$source_dir/README.md" "$source_dir/LICENSE" \
        "$source_dir/setup.py" "$source_dir/aff_runtime" "$source_dir/sim_plant" \
        "$source_dir/aff_hmi" "$source_dir/config" "$build/source"
    run cp -r "$source_dir/deploy/plc" "$build/source/deploy"
    checked "$1" --target "$build/tools" -r "$source_dir/deploy/locks/build.txt"
    run env PYTHONPATH="$build/tools" "$1" -m pip wheel --quiet --no-cache-dir --no-index \
        --no-deps --no-build-isolation --wheel-dir "$build/wheel" "$build/source"
}

# Wheels only, each by its hash: nothing of theirs runs here before it was compared.
checked() {
    interpreter=$1
    shift
    [ -z "$wheels" ] || set -- --no-index --find-links "$wheels" "$@"
    run "$interpreter" -m pip install --quiet --no-cache-dir --only-binary :all: \
        --require-hashes "$@"
}

# Product and packages into an environment: its Python, the extras.
bring() {
    interpreter=$1
    shift
    if [ "$locked" = no ]; then
        extras=$(echo "$*" | tr ' ' ,)
        run "$interpreter" -m pip install --quiet --no-cache-dir --upgrade \
            "$source_dir${extras:+[$extras]}"
        return
    fi
    [ -n "$build$product" ] || make_wheel "$interpreter"
    locks=$*
    set -- -r "$source_dir/deploy/locks/gateway.txt"
    for lock in $locks; do
        set -- "$@" -r "$source_dir/deploy/locks/$lock.txt"
    done
    checked "$interpreter" "$@"
    if [ -n "$product" ]; then
        set -- "$product"
    else
        set -- --find-links "$build/wheel" aff-runtime
    fi
    run "$interpreter" -m pip install --quiet --no-cache-dir --no-index --no-deps \
        --force-reinstall "$@"
}

# Whether the wheel that was given says the commit of this archive.
is_of_this_release() {
    "$python" -c 'import sys, zipfile
name = "aff_runtime/base/release.py"
with open(sys.argv[2] + "/" + name, "rb") as ours:
    sys.exit(zipfile.ZipFile(sys.argv[1]).read(name) != ours.read())' "$product" "$source_dir"
}

if [ "$locked" = no ] && [ -n "$wheels" ]; then
    echo "install.sh: --wheels takes the packages of deploy/locks; leave out --unlocked" >&2
    exit 2
fi
if [ "$locked" = no ] && [ -n "$product" ]; then
    echo "install.sh: --product goes with the packages of deploy/locks; leave out --unlocked" >&2
    exit 2
fi
if [ -n "$product" ] && ! is_of_this_release; then
    echo "install.sh: $product is no wheel of the commit of this archive" >&2
    exit 2
fi
if [ "$compare" = yes ]; then
    found=0
    for place in "$opt" "$hmi_opt"; do
        [ -d "$place/venv" ] || continue
        if [ ! -f "$place/installed.sha256" ]; then
            echo "$place/venv: no list of what was installed; an update writes one"
            found=1
        elif [ -n "$(changed "$place" | head -n 1)" ]; then
            echo "$place/venv: < as installed, > as it is"
            changed "$place"
            found=1
        else
            echo "$place/venv: as installed, $(wc -l < "$place/installed.sha256") files"
        fi
    done
    exit $found
fi
if [ -z "$prefix" ] && [ "$dry_run" = no ] && [ "$(id -u)" -ne 0 ]; then
    echo "install.sh: needs root; or use --prefix DIR, or --dry-run" >&2
    exit 2
fi
if [ "$hmi" = remove ]; then
    if [ -z "$prefix" ]; then
        run systemctl disable --now aff-hmi.service || true
        run systemctl stop aff-commission.service || true
    fi
    # The service's door goes with its next start; until then nobody comes through it.
    run rm -f "$units/aff-runtime.service.d/hmi.conf" "$units/aff-runtime.service.d/screen.conf" \
        "$units/aff-hmi.service" "$units/aff-commission.service" "$units/system-affview.slice"
    run rm -rf "$units/aff-hmi.service.d" "$units/aff-commission.service.d" "$hmi_opt"
    if [ -d "$hmi_etc" ]; then
        if (cd "$hmi_etc" && sha256sum --status -c made.sha256 2> /dev/null); then
            run rm -f "$hmi_etc/key.pem" "$hmi_etc/cert.pem"
        fi
        run rm -f "$hmi_etc/made.sha256"
        run rmdir --ignore-fail-on-non-empty "$hmi_etc"
    fi
    if [ -z "$prefix" ]; then
        # Before the group goes: a service that starts by itself now must not ask for it.
        run systemctl daemon-reload
        if getent passwd aff-hmi > /dev/null; then run userdel aff-hmi; fi
        if getent group aff-door > /dev/null; then run groupdel aff-door; fi
        run rm -f /usr/local/bin/aff-hmi
    fi
    echo "The screen is gone; the service is as it was, and closes its door with its next start."
    exit 0
fi
if ! "$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))'; then
    echo "install.sh: $python is not Python 3.11 to 3.13; name one with --python" >&2
    exit 2
fi

for place in "$opt" "$hmi_opt"; do
    if [ "$fresh" = no ] && [ -n "$(changed "$place" | head -n 1)" ]; then
        echo "install.sh: files below $place/venv are not as they were installed:" >&2
        changed "$place" | head -n 10 >&2
        echo "install.sh: --compare lists them all, --fresh puts a new environment there" >&2
        exit 1
    fi
done

# A screen that is there speaks to the service of the same release only.
if [ "$hmi" = no ] && [ -d "$hmi_opt/venv" ]; then hmi=yes; fi
# What was brought once is of the release of the service: a new environment has it again.
[ ! -e "$units/aff-watch.service" ] || records=yes
[ ! -e "$units/aff-runtime.service.d/can.conf" ] || can=yes
[ ! -e "$units/aff-commission.service.d/plant.conf" ] || plant=yes
if [ "$plant" = yes ] && [ "$hmi" = no ]; then
    echo "install.sh: --plant is for the commissioner, which comes with --hmi" >&2
    exit 2
fi
if [ -z "$prefix" ]; then
    if ! getent passwd aff-runtime > /dev/null; then
        run useradd --system --user-group --home-dir /var/lib/aff-runtime \
            --shell /usr/sbin/nologin aff-runtime
    fi
fi
if [ "$hmi" = yes ] && [ -z "$prefix" ]; then
    getent group aff-door > /dev/null || run groupadd --system aff-door
    if ! getent passwd aff-hmi > /dev/null; then
        run useradd --system --user-group --groups aff-door --no-create-home \
            --home-dir /nonexistent --shell /usr/sbin/nologin aff-hmi
    fi
fi

run mkdir -p "$opt/share" "$etc" "$state/learned" "$state/runs" "$units" "$rules"
environment "$opt"
# No extras unless asked: the service needs neither numba nor scipy nor matplotlib.
set --
[ "$can" = no ] || set -- "$@" can
[ "$records" = no ] || set -- "$@" records
[ "$plant" = no ] || set -- "$@" plant
bring "$opt/venv/bin/python" "$@"
note "$opt"
run cp "$source_dir/deploy/RUNBOOK.md" "$opt/share/RUNBOOK.md"

# The technician's file is never overwritten.
[ -e "$etc/site.yaml" ] || run cp "$source_dir/config/euclid.yaml" "$etc/site.yaml"
[ -e "$etc/learned" ] || [ -L "$etc/learned" ] || run ln -s ../../var/lib/aff-runtime/learned "$etc/learned"

run cp "$source_dir/deploy/aff-runtime.service" "$units/aff-runtime.service"
run mkdir -p "$units/aff-runtime.service.d"
# The technician's file too.
[ -e "$units/aff-runtime.service.d/plc.conf" ] ||
    run cp "$source_dir/deploy/aff-runtime.plc.conf" "$units/aff-runtime.service.d/plc.conf"
# A unit lets programs run from /usr and from its environment: an interpreter elsewhere is named.
base=$("$python" -c 'import sys; print(sys.base_prefix)')
name_interpreter() {
    case $base in
        /usr | /usr/*) run rm -f "$1/python.conf" ;;
        *) put "$1/python.conf" "ExecPaths=$base" ;;
    esac
}
name_interpreter "$units/aff-runtime.service.d"
if [ "$can" = yes ]; then
    run cp "$source_dir/deploy/aff-runtime.can.conf" "$units/aff-runtime.service.d/can.conf"
fi
# Several lines: a template, and per line what is the technician's. A template that is there follows.
for old in "$etc"/lines/*; do
    [ ! -d "$old" ] || lines="$lines ${old##*/}"
done
if [ -n "$lines" ]; then
    run cp "$source_dir/deploy/aff-runtime@.service" "$units/aff-runtime@.service"
    run mkdir -p "$units/aff-runtime@.service.d"
    name_interpreter "$units/aff-runtime@.service.d"
    if [ "$can" = yes ]; then
        run cp "$source_dir/deploy/aff-runtime.can.conf" "$units/aff-runtime@.service.d/can.conf"
    fi
fi
. "$source_dir/deploy/processors.sh"
for line in $(printf '%s\n' $lines | LC_ALL=C sort -u); do
    own=$units/aff-runtime@$line.service.d
    run mkdir -p "$etc/lines/$line" "$state/lines/$line/learned" "$state/lines/$line/runs" "$own"
    [ -e "$etc/lines/$line/site.yaml" ] ||
        run cp "$source_dir/config/euclid.yaml" "$etc/lines/$line/site.yaml"
    [ -e "$etc/lines/$line/learned" ] || [ -L "$etc/lines/$line/learned" ] ||
        run ln -s "../../../../var/lib/aff-runtime/lines/$line/learned" "$etc/lines/$line/learned"
    [ -e "$own/plc.conf" ] || run cp "$source_dir/deploy/aff-runtime.plc.conf" "$own/plc.conf"
    [ -e "$own/cpu.conf" ] || give_processor
done
# Every night, what changes over weeks: brought, and switched on by nobody but a person.
if [ "$records" = yes ]; then
    run mkdir -p "$state/watch" "$units/aff-watch.service.d"
    run cp "$source_dir/deploy/aff-watch.service" "$units/aff-watch.service"
    run cp "$source_dir/deploy/aff-watch.timer" "$units/aff-watch.timer"
    name_interpreter "$units/aff-watch.service.d"
    below_control aff-watch
fi
run cp "$source_dir/deploy/60-aff-runtime.rules" "$rules/60-aff-runtime.rules"

if [ -z "$prefix" ]; then
    run chown -R aff-runtime:aff-runtime /var/lib/aff-runtime
    run systemctl daemon-reload
    run udevadm control --reload
    run udevadm trigger --name-match=cpu_dma_latency
    run ln -sf /opt/aff-runtime/venv/bin/aff-runtime /usr/local/bin/aff-runtime
fi

if [ "$hmi" = yes ]; then
    # An environment of its own: no package of a web server is on the way of the correction.
    run mkdir -p "$hmi_opt" "$units/aff-hmi.service.d"
    environment "$hmi_opt"
    bring "$hmi_opt/venv/bin/python" hmi
    note "$hmi_opt"
    run cp "$source_dir/deploy/aff-hmi.service" "$units/aff-hmi.service"
    run cp "$source_dir/deploy/system-affview.slice" "$units/system-affview.slice"
    run cp "$source_dir/deploy/aff-runtime.hmi.conf" "$units/aff-runtime.service.d/hmi.conf"
    # The commissioner: brought, and started by nobody but a person.
    run cp "$source_dir/deploy/aff-commission.service" "$units/aff-commission.service"
    run mkdir -p "$units/aff-commission.service.d"
    # What one may reach, the other may.
    run ln -sfn ../aff-runtime.service.d/plc.conf "$units/aff-commission.service.d/plc.conf"
    [ "$can" = no ] ||
        run ln -sfn ../aff-runtime.service.d/can.conf "$units/aff-commission.service.d/can.conf"
    # numba, which refines, compiles what it runs.
    [ "$plant" = no ] ||
        put "$units/aff-commission.service.d/plant.conf" "MemoryDenyWriteExecute=no"
    # The technician's files.
    [ -e "$units/aff-hmi.service.d/listen.conf" ] ||
        run cp "$source_dir/deploy/aff-hmi.listen.conf" "$units/aff-hmi.service.d/listen.conf"
    [ -e "$units/aff-runtime.service.d/screen.conf" ] ||
        run cp "$source_dir/deploy/aff-runtime.screen.conf" \
            "$units/aff-runtime.service.d/screen.conf"
    for unit in aff-hmi aff-commission; do
        name_interpreter "$units/$unit.service.d"
        below_control $unit
    done
    run mkdir -p "$hmi_etc"
    run chmod 0750 "$hmi_etc"
    # A key of its own and a certificate signed by itself, for the day on which listen.conf names
    # them: elliptic (P-256), as a handshake by RSA costs a gateway several times as much. What is
    # there, also one of the plant's own authority, stays.
    if [ ! -e "$hmi_etc/key.pem" ] && [ ! -e "$hmi_etc/cert.pem" ] &&
        command -v openssl > /dev/null; then
        host=$(uname -n)
        umask 077
        run openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 365 \
            -subj "/CN=$host" -addext "subjectAltName=DNS:$host" \
            -keyout "$hmi_etc/key.pem" -out "$hmi_etc/cert.pem"
        umask 022
        run chmod 0640 "$hmi_etc/key.pem"
        run chmod 0644 "$hmi_etc/cert.pem"
        if [ -z "$prefix" ]; then run chgrp aff-hmi "$hmi_etc/key.pem"; fi
        # By this --remove-hmi knows them again: what somebody put in their place is his.
        [ "$dry_run" = yes ] || (cd "$hmi_etc" && sha256sum key.pem cert.pem > made.sha256)
    fi
    if [ -z "$prefix" ]; then
        # Screen and commissioner read the accounts; a key of group aff-hmi the screen alone.
        run chown root:aff-door "$hmi_etc"
        [ ! -e "$hmi_etc/accounts" ] || run chgrp aff-door "$hmi_etc/accounts"
        run ln -sf /opt/aff-hmi/venv/bin/aff-hmi /usr/local/bin/aff-hmi
        run systemctl daemon-reload
    fi
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
for line in $lines; do
    cat << DONE
Line $line: edit $etc/lines/$line/site.yaml and
  $units/aff-runtime@$line.service.d/plc.conf (systemctl daemon-reload), then
  systemctl enable --now aff-runtime@$line
  sudo -u aff-runtime aff-runtime status --runtime-dir /run/aff-runtime-$line
DONE
done
[ "$records" = no ] || cat << DONE
Every night what changes over weeks, once the line runs: systemctl enable --now aff-watch.timer
DONE
[ "$hmi" = no ] || cat << DONE
The screen: restart aff-runtime as above (it opens its door), then
  systemctl enable aff-hmi && systemctl restart aff-hmi
and look at http://127.0.0.1:8480/ ; from a network: $units/aff-hmi.service.d/listen.conf
To bypass, arm or commission there: $units/aff-runtime.service.d/screen.conf
DONE
if [ "$hmi" = yes ] && [ -r "$hmi_etc/cert.pem" ] && command -v openssl > /dev/null; then
    # What a browser shows of it when it asks whether to trust.
    openssl x509 -in "$hmi_etc/cert.pem" -noout -fingerprint -sha256 -enddate || :
fi
