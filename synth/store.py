"""Results on disk: each under the key that it is given, whole or not at all.

An entry is a pickle behind a digest of itself, written to one side and moved into place, so a reader sees all of it or
none. An entry that is cut short, altered, or no longer readable counts as missing. Of processes that want the same
result one computes it while the others wait; the lock goes with the process that holds it, a killed one too. Where the
folder cannot be written, results are computed and not kept.

Reading a pickle runs what is in it. The folder is the user's own, as are the programs that he runs: do not share it
with people whom you would not let run commands in your name.

With SYNTH_FRESH set, to any name of the run, an entry is read only if it was made under the same name: such a run
trusts nothing older than itself, makes everything once, and leaves the new entries for others.
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

T = TypeVar("T")

FRESH = "SYNTH_FRESH"
MAGIC = b"synth cache 1\n"
LIMIT = 4 * 2**30  # bytes of results kept, those that were not used for the longest time left out


def folder() -> Path:
    """Return where results are kept: `$SYNTH_CACHE`, else `$XDG_CACHE_HOME/synth`, else `~/.cache/synth`."""
    if chosen := os.environ.get("SYNTH_CACHE"):
        return Path(chosen).absolute()
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "synth"


def run_name() -> str:
    """Return the name of a run that trusts nothing older than itself, '' for one that reads all entries."""
    return os.environ.get(FRESH, "")


def fetch(name: str, compute: Callable[[], T]) -> T:
    """Return the result kept under a key, or compute it and keep it."""
    path = _path(name)
    with suppress(_Missing):
        return _read(path)
    with _lock(path):
        with suppress(_Missing):  # another process has made it meanwhile
            return _read(path)
        result = compute()
        _write(path, result)
    return result


def holds(name: str) -> bool:
    """Whether there is a result under a key that can be read."""
    try:
        _read(_path(name))
    except _Missing:
        return False
    return True


def replace_text(path: Path, text: str) -> None:
    """Write a text file in one step: whoever reads it, and an interrupt, finds the old text or the new one."""
    path = path.resolve()
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        beside.write_text(text, encoding="utf-8")
        os.replace(beside, path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


@contextmanager
def fresh_run() -> Iterator[None]:
    """Let what is done inside trust no result that is older than it; processes begun inside do likewise."""
    before = os.environ.get(FRESH)
    os.environ[FRESH] = before or uuid.uuid4().hex
    try:
        yield
    finally:
        if before is None:
            del os.environ[FRESH]


def trim(limit: int = LIMIT) -> None:
    """Remove the entries that were not used for the longest time, until `limit` bytes are left."""
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
    """There is no entry that can be read."""


def _read(path: Path) -> Any:
    try:
        entry = path.read_bytes()
        head, check, run, body = entry.split(b"\n", 3)
    except (OSError, ValueError):
        raise _Missing from None
    intact = head + b"\n" == MAGIC and check == _check(path, run, body)
    if not intact or (run_name() and run != run_name().encode()):
        raise _Missing
    try:
        result = pickle.loads(body)
    except Exception:  # a pickle of classes that have moved since raises anything
        raise _Missing from None
    with suppress(OSError):
        os.utime(path)  # for `trim`
    return result


def _write(path: Path, result: Any) -> None:
    """Write an entry; nothing where the folder cannot be written, or where the result is no data."""
    with suppress(OSError, pickle.PicklingError, AttributeError, TypeError):
        run, body = run_name().encode(), pickle.dumps(result, protocol=pickle.HIGHEST_PROTOCOL)
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".writing-", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(b"\n".join([MAGIC.rstrip(b"\n"), _check(path, run, body), run, body]))
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise


def _check(path: Path, run: bytes, body: bytes) -> bytes:
    """Return the digest of an entry; its own place counts, so that none can stand in for another."""
    return hashlib.sha256(b"\n".join([path.name.encode(), run, body])).hexdigest().encode()


@contextmanager
def _lock(path: Path) -> Iterator[None]:
    """Hold the lock of a key, which ends with the process; none where the folder takes no locks."""
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
        # Who held it last has removed the file, and another process may hold one of the same name by now.
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(handle), os.stat(lock)):
                return handle
        os.close(handle)
