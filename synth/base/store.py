"""On-disk key-value store of pickled results, with atomic writes and a lock for each key.

An entry is a pickle after its digest. It is written to a temporary file and renamed: a reader sees all of it or
nothing. A truncated, altered or unreadable entry counts as missing. When several processes need the same result, one
computes it and the others wait; the lock ends with its process, even a killed one. Where the folder cannot be written,
results are computed and not stored.

Reading a pickle can run code. Do not share the folder with people whom you would not let run commands in your name.

With SYNTH_FRESH set to any name of a run, only entries made under the same name are read: such a run ignores older
entries, computes everything once, and leaves new entries for others.
"""

import fcntl
import hashlib
import os
import pickle
import tempfile
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeVar

from synth.errors import SynthError

T = TypeVar("T")

FRESH = "SYNTH_FRESH"
MAGIC = b"synth cache 1\n"
MAX_BYTES = 4 * 2**30  # bytes of stored results; the least recently used ones are removed


def folder() -> Path:
    """Return the folder of the results: `$SYNTH_CACHE`, else `$XDG_CACHE_HOME/synth`, else `~/.cache/synth`.

    Raises SynthError when none of them names a folder.
    """
    if chosen := os.environ.get("SYNTH_CACHE"):
        return Path(chosen).absolute()
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base).absolute() / "synth"
    try:
        return Path.home() / ".cache" / "synth"
    except RuntimeError as error:
        raise SynthError(
            f"cache: HOME is not set and the system knows no home of user {os.getuid()}, a folder is needed: "
            "set SYNTH_CACHE to one that can be written"
        ) from error


def run_name() -> str:
    """Return the name of a run that ignores older entries, '' for one that reads all entries."""
    return os.environ.get(FRESH, "")


def fetch(name: str, compute: Callable[[], T]) -> T:
    """Return the result stored under a key, or compute and store it."""
    path = _path(name)
    with suppress(_Missing):
        return _read(path)
    with _lock(path):
        with suppress(_Missing):  # another process has computed it meanwhile
            return _read(path)
        result = compute()
        _write(path, result)
    return result


def holds(name: str) -> bool:
    """Return whether a readable result is stored under a key."""
    try:
        _read(_path(name))
    except _Missing:
        return False
    return True


def find(name: str) -> Any:
    """Return the readable result that is stored under a key, None where there is none."""
    try:
        return _read(_path(name))
    except _Missing:
        return None


def replace_text(path: Path, text: str) -> None:
    """Write a text file in one step: whoever reads it, and an interrupt, finds the old text or the new one."""
    replace_bytes(path, text.encode("utf-8"))


def replace_bytes(path: Path, content: bytes) -> None:
    """Write a file in one step, as `replace_text`."""
    path = path.resolve()
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(content)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


@contextmanager
def fresh_run() -> Iterator[None]:
    """Ignore older results inside the context, also in processes that are started there."""
    before = os.environ.get(FRESH)
    os.environ[FRESH] = before or uuid.uuid4().hex
    try:
        yield
    finally:
        if before is None:
            del os.environ[FRESH]


def trim(limit: int = MAX_BYTES) -> None:
    """Remove the least recently used entries until `limit` bytes are left."""
    with suppress(OSError):
        entries = [(p, p.stat()) for p in (folder() / "results").glob("??/*") if p.is_file()]
        total = sum(s.st_size for _, s in entries)
        for path, status in sorted(entries, key=lambda e: e[1].st_mtime_ns):
            if total <= limit:
                return
            path.unlink(missing_ok=True)
            total -= status.st_size


def _path(name: str) -> Path:
    return folder() / "results" / name[:2] / name[2:]


class _Missing(Exception):
    """No readable entry."""


def _read(path: Path) -> Any:
    try:
        entry = path.read_bytes()
        magic, digest, run, body = entry.split(b"\n", 3)
    except (OSError, ValueError):
        raise _Missing from None
    intact = magic + b"\n" == MAGIC and digest == _digest(path, run, body)
    if not intact or (run_name() and run != run_name().encode()):
        raise _Missing
    try:
        result = pickle.loads(body)
    except Exception:  # unpickling a class that no longer exists may raise any exception
        raise _Missing from None
    with suppress(OSError):
        os.utime(path)  # for `trim`
    return result


def _write(path: Path, result: Any) -> None:
    """Write an entry; do nothing where the folder cannot be written or the result cannot be pickled."""
    with suppress(OSError, pickle.PicklingError, AttributeError, TypeError):
        run, body = run_name().encode(), pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".writing-", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(b"\n".join([MAGIC.rstrip(b"\n"), _digest(path, run, body), run, body]))
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise


def _digest(path: Path, run: bytes, body: bytes) -> bytes:
    """Return the digest of an entry with its file name: an entry under another name is not valid."""
    return hashlib.sha256(b"\n".join([path.name.encode(), run, body])).hexdigest().encode()


@contextmanager
def _lock(path: Path) -> Iterator[None]:
    """Hold the lock of a key, which ends with the process; no lock where the folder does not support locks."""
    lock = folder() / "locks" / path.name
    try:
        handle = _open_lock(lock)
    except OSError:
        yield
        return
    try:
        yield
    finally:
        with suppress(OSError):
            lock.unlink()
        os.close(handle)


def _open_lock(lock: Path) -> int:
    lock.parent.mkdir(parents=True, exist_ok=True)
    while True:
        handle = os.open(lock, os.O_RDWR | os.O_CREAT, 0o600)
        fcntl.flock(handle, fcntl.LOCK_EX)
        # The last holder has removed the file, and another process may hold a new one of the same name.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(handle), os.stat(lock)):
                return handle
        os.close(handle)
