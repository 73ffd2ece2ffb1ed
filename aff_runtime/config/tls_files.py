"""The certificates that a site names: there, readable, belonging together, in force."""

from __future__ import annotations

import ssl
import stat
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

from aff_runtime.base.clock import wall_time_s
from aff_runtime.config.models import Site, Tls
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.rules.issue import Issue
from aff_runtime.config.x509 import (
    CERTIFICATE,
    REVOCATION_LIST,
    list_dates,
    list_issuer,
    pem_blocks,
    subject,
    validity,
)

SOON = timedelta(days=30)  # time enough to have a certificate renewed, and a stop to put it in
_PATH = ("gateway", "modbus_tcp", "tls")


def issues(site: Site, folder: Path, now_s: float | None = None) -> Iterator[Issue]:
    """Yield what is wrong with the files; dates only warn, for the clock may be the one to blame.

    Parameters
    ----------
    folder : where relative names begin.
    now_s : wall clock, s; absent: the machine's.
    """
    tcp = site.gateway.modbus_tcp
    if tcp is None or tcp.tls is None:
        return
    tls = tcp.tls
    if tls.private_key is not None and tls.certificate is None:
        yield Issue(
            path=(*_PATH, "private_key"),
            text="a key without certificate: serves no one. Name the certificate, or neither.",
        )
        return
    found = list(_unreadable(tls, folder))
    found = found or [*_unfit(tls, folder), *_unfit_list(tls, folder)]
    yield from found
    if not found:
        now = datetime.fromtimestamp(wall_time_s() if now_s is None else now_s, UTC)
        yield from _open_key(tls, folder)
        yield from _out_of_date(tls, folder, now)
        yield from _list_out_of_date(tls, folder, now)


def _unreadable(tls: Tls, folder: Path) -> Iterator[Issue]:
    for key, name in tls.files().items():
        try:
            read_plain(folder / name)
        except ValueError as error:
            yield Issue(path=(*_PATH, key), text=f"{folder / name} {error}. Correct the name.")
        except OSError as error:
            text = (
                f"{folder / name} cannot be read ({error.strerror}). Put the PEM file there, "
                "readable by the user of the service, or correct the name."
            )
            yield Issue(path=(*_PATH, key), text=text)


def _unfit(tls: Tls, folder: Path) -> Iterator[Issue]:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    try:
        context.load_verify_locations(folder / tls.ca)
    except (OSError, ValueError) as error:
        text = f"{tls.ca} holds no PEM certificate that can be used ({error})."
        yield Issue(path=(*_PATH, "ca"), text=text)
    if tls.certificate is None:
        return
    if not _blocks(folder / tls.certificate, CERTIFICATE):
        yield Issue(
            path=(*_PATH, "certificate"), text=f"{tls.certificate} holds no PEM certificate."
        )
        return
    key, name = _key_file(tls, tls.certificate)
    try:
        context.load_cert_chain(folder / tls.certificate, folder / name, password=_nobody)
    except ssl.SSLError as error:
        text = f"{name} holds no PEM key that can be used ({error})."
        if error.reason == "KEY_VALUES_MISMATCH":
            text = f"the key in {name} does not belong to the certificate in {tls.certificate}."
        yield Issue(path=(*_PATH, key), text=text)
    except (OSError, ValueError) as error:
        yield Issue(path=(*_PATH, key), text=f"{name}: {error}.")


def _nobody() -> str:
    raise ValueError(
        "the key is encrypted, and nobody is there to type its password. Store it without one, "
        "readable by the user of the service alone"
    )


def _unfit_list(tls: Tls, folder: Path) -> Iterator[Issue]:
    """Yield what is wrong with the revocation list: with such a one no PLC would be spoken to."""
    if tls.crl is None:
        return
    lists = _blocks(folder / tls.crl, REVOCATION_LIST)
    text = f"{tls.crl} holds no PEM revocation list (X509 CRL) that can be used."
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT).load_verify_locations(folder / tls.crl)
        owners = {subject(der) for der in _blocks(folder / tls.ca, CERTIFICATE)}
        if owners & {list_issuer(der) for der in lists}:
            return
        if lists:
            text = f"{tls.crl} is not of the authority whose certificate is in {tls.ca}."
    except (OSError, ValueError):
        pass
    yield Issue(path=(*_PATH, "crl"), text=text)


def _open_key(tls: Tls, folder: Path) -> Iterator[Issue]:
    """Yield a warning for a key that every user of the machine can take."""
    if tls.certificate is None:
        return
    key, name = _key_file(tls, tls.certificate)
    mode = (folder / name).stat().st_mode
    if mode & stat.S_IROTH:
        text = (
            f"every user of this machine can read the key in {name} (mode "
            f"{stat.S_IMODE(mode):04o}) and speak to the PLC in our name. chmod 0640 it, with "
            "the service's group."
        )
        yield Issue(path=(*_PATH, key), text=text, warning=True)


def _out_of_date(tls: Tls, folder: Path, now: datetime) -> Iterator[Issue]:
    """Yield a warning per certificate that is not in force, or not for long any more."""
    for key, name in tls.files().items():
        for der in _blocks(folder / name, CERTIFICATE) if key in ("ca", "certificate") else ():
            try:
                first, last = validity(der)
            except ValueError:
                continue  # whether it can be used at all, TLS has said
            text = ""
            if now > last:
                text = f"expired on {last:%Y-%m-%d}: no connection is made with it. Renew it"
            elif now < first:
                text = f"is in force from {first:%Y-%m-%d} on: no connection before"
            elif now > last - SOON:
                days = (last - now).days
                text = (
                    f"expires on {last:%Y-%m-%d}, in {days} day{'' if days == 1 else 's'}: no "
                    "connection is made after that. Renew it"
                )
            if text:
                yield _dated(key, f"a certificate in {name} {text}", now)


def _list_out_of_date(tls: Tls, folder: Path, now: datetime) -> Iterator[Issue]:
    """Yield a warning for a revocation list that should have been renewed: it bars everybody."""
    for der in _blocks(folder / tls.crl, REVOCATION_LIST) if tls.crl is not None else ():
        try:
            issued, due = list_dates(der)
        except ValueError:
            continue
        text = ""
        if due is not None and now > due:
            text = f"was to be renewed by {due:%Y-%m-%d}: no connection is made with it. Renew it"
        elif now < issued:
            text = f"is of {issued:%Y-%m-%d}: no connection before"
        if text:
            yield _dated("crl", f"the list in {tls.crl} {text}", now)


def _dated(key: str, text: str, now: datetime) -> Issue:
    text = f"{text} (this machine's clock: {now:%Y-%m-%d})."
    return Issue(path=(*_PATH, key), text=text, warning=True)


def _key_file(tls: Tls, certificate: str) -> tuple[str, str]:
    """Return key and name of the file that holds our private key."""
    if tls.private_key is None:
        return "certificate", certificate
    return "private_key", tls.private_key


def _blocks(path: Path, label: str) -> list[bytes]:
    return pem_blocks(path.read_text(encoding="latin-1"), label)
