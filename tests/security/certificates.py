"""An authority of our own and what it signs, by openssl: good certificates and odd ones."""

from __future__ import annotations

import subprocess
from pathlib import Path

_CONFIG = """
[ca]
default_ca = ours
[ours]
dir = {folder}
database = {folder}/{name}.index
serial = {folder}/{name}.serial
crlnumber = {folder}/{name}.crlnumber
new_certs_dir = {folder}
certificate = {folder}/{name}.pem
private_key = {folder}/{name}.key
default_md = sha256
default_days = 90
default_crl_days = 90
policy = anything
unique_subject = no
[anything]
commonName = supplied
[req]
distinguished_name = name
prompt = no
[name]
CN = nobody
"""
EC = ("ec", "-pkeyopt", "ec_paramgen_curve:prime256v1")


def openssl(*arguments: str | Path) -> None:
    """Run openssl; a failure shows what it said."""
    done = subprocess.run(["openssl", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


class Authority:
    """One certificate authority in a folder.

    Parameters
    ----------
    folder : where its files and those it signs lie, ``NAME.pem`` and ``NAME.key``.
    name : of the authority.
    """

    def __init__(self, folder: Path, name: str = "authority") -> None:
        self.folder, self.name = folder, name
        self._config = folder / f"{name}.cnf"
        self._config.write_text(_CONFIG.format(folder=folder, name=name))
        (folder / f"{name}.index").touch()
        (folder / f"{name}.serial").write_text("01\n")
        (folder / f"{name}.crlnumber").write_text("01\n")
        openssl(
            *("req", "-x509", "-newkey", *EC, "-nodes", "-days", "900", "-config", self._config),
            *("-subj", f"/CN={name}", "-addext", "basicConstraints=critical,CA:TRUE"),
            *("-addext", "keyUsage=keyCertSign,cRLSign", "-addext", "subjectKeyIdentifier=hash"),
            *("-keyout", folder / f"{name}.key", "-out", self.certificate),
        )

    @property
    def certificate(self) -> Path:
        """Its own certificate."""
        return self.folder / f"{self.name}.pem"

    def sign(
        self,
        name: str,
        *,
        names: str = "DNS:plc",
        subject: str = "plc",
        usage: str = "serverAuth,clientAuth",
        key: tuple[str, ...] = EC,
        digest: str = "sha256",
        begin: str = "20240101000000Z",
        end: str = "20900101000000Z",
    ) -> Path:
        """Make a key and a certificate for it; return the certificate.

        Parameters
        ----------
        names : subjectAltName; empty: none.
        subject : common name.
        usage : extendedKeyUsage.
        key : of openssl's ``-newkey``.
        digest : of the signature.
        begin, end : in force, as ``YYYYMMDDhhmmssZ``.
        """
        request, extras = self.folder / f"{name}.csr", self.folder / f"{name}.ext"
        extras.write_text(
            f"extendedKeyUsage={usage}\n" + (f"subjectAltName={names}\n" if names else "")
        )
        openssl(
            *("req", "-newkey", *key, "-nodes", "-subj", f"/CN={subject}"),
            *("-config", self._config),
            *("-keyout", self.folder / f"{name}.key", "-out", request),
        )
        made = self.folder / f"{name}.pem"
        openssl(
            *("ca", "-batch", "-notext", "-config", self._config, "-md", digest, "-in", request),
            *("-out", made, "-extfile", extras, "-startdate", begin, "-enddate", end),
        )
        return made

    def revoke(self, certificate: Path) -> None:
        """Take a certificate back; a list made later says so."""
        openssl("ca", "-config", self._config, "-revoke", certificate)

    def revocation_list(self, name: str, *, begin: str = "", end: str = "") -> Path:
        """Make a list of what has been taken back; return its file."""
        made = self.folder / f"{name}.pem"
        dates = ("-crl_lastupdate", begin, "-crl_nextupdate", end) if begin else ()
        openssl("ca", "-gencrl", "-config", self._config, *dates, "-out", made)
        return made
