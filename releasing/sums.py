"""SHA-256 of every file of a release, signed with a key of the user's."""

from __future__ import annotations

import hashlib
from pathlib import Path

from releasing.commands import run, tool

SUMS = "SHA256SUMS"
NAMESPACE = "aff-runtime-release"
UNSIGNED = (
    "not signed: SHA256SUMS shows that files arrived whole, not who made them; nobody can tell "
    "this release from another one by its files. make release SIGN=KEY signs: a key id of gpg, "
    "or the file of an ssh key"
)


def sha256(path: Path) -> str:
    """Return the digest of a file, hexadecimal."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def write_sums(folder: Path) -> Path:
    """Write the digest of every file of a folder, as ``sha256sum --check`` reads them."""
    files = sorted(path for path in folder.iterdir() if not path.name.startswith(SUMS))
    out = folder / SUMS
    out.write_text("".join(f"{sha256(path)}  {path.name}\n" for path in files))
    return out


def sign(sums: Path, key: str) -> str:
    """Sign the sums and try the signature; return what was done, or that nothing was.

    Parameters
    ----------
    key : file of an ssh key, or a key id of gpg; empty: no signature.

    Raises
    ------
    ReleaseError
        The key cannot sign.
    """
    if not key:
        return UNSIGNED
    if Path(key).is_file():
        out = sums.with_name(f"{sums.name}.sig")
        out.unlink(missing_ok=True)
        run([tool("ssh-keygen"), "-q", "-Y", "sign", "-n", NAMESPACE, "-f", key, str(sums)])
        return f"signed: {out.name} (ssh-keygen, namespace {NAMESPACE})"
    out = sums.with_name(f"{sums.name}.asc")
    gpg = [tool("gpg"), "--batch", "--yes"]
    run([*gpg, "--local-user", key, "--armor", "--output", str(out), "--detach-sign", str(sums)])
    run([*gpg, "--verify", str(out), str(sums)])
    return f"signed: {out.name} (gpg, {key})"
