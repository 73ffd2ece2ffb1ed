"""``python -m tests.socketcan``: boot a Debian kernel under QEMU and test on genuine vcan.

The guest is a busybox, a handful of kernel modules, and this machine's own files, read only over
9p; so the tests run with the interpreter and packages of this very checkout. Functional only: an
emulated processor says nothing about time. Exit code 0 with a reason where it cannot be run.
"""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORK = Path(os.environ.get("AFF_SOCKETCAN_DIR", ROOT / "out" / "socketcan"))
MODULES = ("virtio_pci", "9pnet_virtio", "9p", "can-raw", "can-bcm", "vcan")
PATIENCE_S = 1200
INIT = """#!/bin/busybox sh
/bin/busybox mkdir -p /proc /sys /dev /host
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t sysfs sys /sys
/bin/busybox mount -t devtmpfs dev /dev
for module in {modules}; do /bin/busybox insmod /modules/$module.ko; done
/bin/busybox ip link add vcan0 type vcan
/bin/busybox ip link set vcan0 up
/bin/busybox ip link set lo up
/bin/busybox mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144,cache=loose,ro host /host
/bin/busybox mount -t proc proc /host/proc
/bin/busybox mount -t sysfs sys /host/sys
/bin/busybox mount -t devtmpfs dev /host/dev
/bin/busybox mkdir -p /host/dev/shm
/bin/busybox mount -t tmpfs shm /host/dev/shm
echo "host mounted: $(/bin/busybox ls /host | /bin/busybox wc -w) entries"
cd /host
/bin/busybox chroot /host /bin/sh -c 'cd {root} && export HOME=/dev/shm TMPDIR=/dev/shm && \\
  PYTHONDONTWRITEBYTECODE=1 {python} -m pytest -v --color=no --tb=short \\
  -p no:cacheprovider -p no:hypothesispytest --durations=0 --timeout 300 \\
  tests/socketcan/on_vcan.py'
echo "SOCKETCAN-EXIT $?"
/bin/busybox poweroff -f
"""


def why_not() -> str:
    """Return why it cannot be run here; empty when it can."""
    for tool in ("qemu-system-x86_64", "apt-get", "dpkg-deb"):
        if shutil.which(tool) is None:
            return f"{tool} is not installed"
    return ""


def fetch() -> tuple[Path, Path, Path]:
    """Return kernel, folder of its modules, and busybox; downloaded once into ``WORK``."""
    WORK.mkdir(parents=True, exist_ok=True)
    tree = WORK / "tree"
    if not tree.exists():
        listed = subprocess.run(
            ["apt-cache", "depends", "linux-image-amd64"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        found = re.search(r"linux-image-\d\S*-amd64", listed)
        if found is None:
            raise RuntimeError("no linux-image package is known to apt")
        names = (found[0], "busybox-static")
        subprocess.run(["apt-get", "download", *names], cwd=WORK, check=True, capture_output=True)
        for package in WORK.glob("*.deb"):
            subprocess.run(["dpkg-deb", "-x", package, tree], check=True)
    (kernel,) = tree.glob("boot/vmlinuz-*")
    (modules,) = tree.glob("lib/modules/*/kernel")
    return kernel, modules, tree / "bin" / "busybox"


def load_order(modules: Path) -> list[Path]:
    """Return the modules of ``MODULES`` and what they depend on, dependencies first."""
    files = {
        path.name.removesuffix(".ko").replace("_", "-"): path for path in modules.rglob("*.ko")
    }
    order: list[Path] = []

    def add(name: str) -> None:
        path = files.get(name.replace("_", "-"))
        if path is None or path in order:
            return  # built into the kernel, or there already
        found = re.search(rb"\0depends=([^\0]*)\0", b"\0" + path.read_bytes())
        for needed in (found[1].decode() if found else "").split(","):
            if needed:
                add(needed)
        order.append(path)

    for name in MODULES:
        add(name)
    return order


def initramfs(modules: list[Path], busybox: Path) -> Path:
    """Build the guest's first files; return the archive."""
    folder = WORK / "initramfs"
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "bin").mkdir(parents=True)
    (folder / "modules").mkdir()
    shutil.copy(busybox, folder / "bin" / "busybox")
    for path in modules:
        shutil.copy(path, folder / "modules" / path.name)
    names = " ".join(path.name.removesuffix(".ko") for path in modules)
    script = INIT.format(modules=names, root=ROOT, python=sys.executable)
    (folder / "init").write_text(script)
    (folder / "init").chmod(0o755)
    archive = WORK / "initramfs.cpio"
    with archive.open("wb") as out:
        for path in sorted(folder.rglob("*")):
            content = b"" if path.is_dir() else path.read_bytes()
            out.write(_newc(str(path.relative_to(folder)), path.stat().st_mode, content))
        out.write(_newc("TRAILER!!!", 0, b""))
    return archive


def _newc(name: str, mode: int, content: bytes) -> bytes:
    """Return one entry of a cpio archive in the kernel's format (newc)."""
    fields = (0, mode, 0, 0, 1, 0, len(content), 0, 0, 0, 0, len(name) + 1, 0)
    head = b"070701" + b"".join(b"%08X" % field for field in fields) + name.encode() + b"\0"
    padded = head + b"\0" * (-len(head) % 4)
    return padded + content + b"\0" * (-len(content) % 4)


def main() -> int:
    """Run the guest; its tests' exit code, 0 with a reason when it cannot be run."""
    reason = why_not()
    if reason:
        print(f"test-socketcan skipped: {reason}")
        return 0
    try:
        kernel, modules, busybox = fetch()
    except (subprocess.CalledProcessError, RuntimeError, ValueError) as error:
        print(f"test-socketcan skipped: kernel or busybox cannot be fetched ({error})")
        return 0
    archive = initramfs(load_order(modules), busybox)
    command = [
        "nice",
        "-n",
        "19",
        "qemu-system-x86_64",
        "-accel",
        "tcg",
        "-cpu",
        "max",
        "-smp",
        "2",
        "-m",
        "1024",
        "-kernel",
        str(kernel),
        "-initrd",
        str(archive),
        "-nographic",
        "-no-reboot",
        "-append",
        "console=ttyS0 panic=-1 quiet",
        "-nic",
        "none",
        "-virtfs",
        "local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap",
    ]
    said = io.StringIO()
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, text=True, errors="replace", stdin=subprocess.DEVNULL
    ) as guest:
        assert guest.stdout is not None
        bound = threading.Timer(PATIENCE_S, guest.kill)
        bound.start()
        for line in guest.stdout:
            print(line, end="", flush=True)
            said.write(line)
            if line.startswith("SOCKETCAN-EXIT"):
                break
        bound.cancel()
        guest.terminate()
    found = re.search(r"SOCKETCAN-EXIT (\d+)", said.getvalue())
    if found is None:
        print(f"the guest ended, or was ended after {PATIENCE_S} s, without a result")
    return int(found[1]) if found else 1


if __name__ == "__main__":
    sys.exit(main())
