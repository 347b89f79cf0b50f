"""Addresses of the live server: their secret parts, the QR code, and a certificate made on the spot."""

import io
import ipaddress
import secrets
import socket
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

from pdr_est.output.atomic_output import write_text

CERTIFICATE_DAYS = 30
"""Days for which the certificate is valid."""

_EVERYWHERE = ("0.0.0.0", "::")
_SOMEWHERE_ELSE = "192.0.2.1"  # an address for documentation: asking for the way to it sends nothing


def new_token() -> str:
    """Make a secret part of an address, of 128 random bits."""
    return secrets.token_urlsafe(16)


def is_loopback(host: str) -> bool:
    """Tell whether a host can only be reached from this computer."""
    return host == "localhost" or (_is_ip(host) and ipaddress.ip_address(host).is_loopback)


def host_for_others(host: str) -> str:
    """Return the host as other computers call it: for all interfaces, the address towards the network."""
    if host not in _EVERYWHERE:
        return host
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((_SOMEWHERE_ELSE, 9))
            return str(probe.getsockname()[0])
        except OSError:
            return socket.gethostname()


def qr_code_text(address: str) -> str:
    """Draw the QR code of an address with characters of a terminal."""
    import segno

    drawing = io.StringIO()
    segno.make(address, error="l", micro=False).terminal(drawing, compact=True)
    return drawing.getvalue()


def make_certificate(folder: Path, hosts: Sequence[str]) -> tuple[Path, Path]:
    """Make a key and a certificate that nobody has signed, for a phone that needs a secure page for its sensors.

    Parameters
    ----------
    folder
        Folder that nobody else may read.
    hosts
        Names and addresses of this computer.

    Returns
    -------
    tuple of Path
        Certificate and key.
    """
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.x509.oid import ExtendedKeyUsageOID

    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "pdr-est live")])
    names = [x509.IPAddress(ipaddress.ip_address(host)) if _is_ip(host) else x509.DNSName(host) for host in hosts]
    now = datetime.now(UTC)
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + timedelta(days=CERTIFICATE_DAYS))
        .add_extension(x509.SubjectAlternativeName(names), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(key, hashes.SHA256())
    )
    certificate, private = folder / "certificate.pem", folder / "key.pem"
    write_text(certificate, made.public_bytes(serialization.Encoding.PEM).decode())
    unencrypted = serialization.NoEncryption()
    pem = key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, unencrypted)
    write_text(private, pem.decode())
    return certificate, private


def _is_ip(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True
