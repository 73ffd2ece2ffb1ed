# An environment is made, whole or not at all, and compared with what was installed into it. Read by
# install.sh; wants its run, $dry_run, $fresh, $python.

# Every file of an environment with its hash, every link with its end; what Python writes by itself
# is left out.
listed() {
    (cd "$1" && find . -name __pycache__ -prune -o -type f -print0 | LC_ALL=C sort -z |
        xargs -0 -r sha256sum && find . -type l -printf 'link %p %l\n' | LC_ALL=C sort)
}

# What of an environment is not as it was installed, a line each; nothing where there is no list.
changed() {
    [ -f "$1/installed.sha256" ] || return 0
    listed "$1/venv" | LC_ALL=C diff "$1/installed.sha256" - |
        sed -n 's/^\([<>]\) \(.*\)$/\1 \2/p' || true
}

# The list of what was installed, beside the environment.
note() {
    echo "+ $1/installed.sha256"
    [ "$dry_run" = yes ] || listed "$1/venv" > "$1/installed.sha256"
    [ "$fresh" = no ] || run rm -rf "$1/venv.before"
}

# An environment to put packages into. A new one does not take away the one that works before it
# is whole.
environment() {
    if [ "$fresh" = yes ] && [ -d "$1/venv" ]; then
        run rm -rf "$1/venv.before"
        run mv "$1/venv" "$1/venv.before"
    fi
    # One without pip, and without a list of what was installed, never was whole.
    if [ -d "$1/venv" ]; then
        if is_whole "$1" || [ -f "$1/installed.sha256" ]; then return; fi
        run rm -rf "$1/venv"
    fi
    run "$python" -m venv "$1/venv" || no_environment "$1"
    [ "$dry_run" = yes ] || is_whole "$1" || no_environment "$1"
}

is_whole() {
    [ -x "$1/venv/bin/python" ] && "$1/venv/bin/python" -m pip --version > /dev/null 2>&1
}

no_environment() {
    rm -rf "$1/venv"
    echo "install.sh: $python makes no environment with pip in it. On Debian and Ubuntu:" >&2
    echo "  apt-get install python3-venv (of another Python python3.12-venv), then run this again" >&2
    exit 1
}
