# The exceptions of the package.
"""What can go wrong: each says in one sentence what was found, what is expected, and where."""
import re
from typing import List, NamedTuple, Optional

_PLACE = re.compile(r"^(?P<file>[^:\n]+?)(?::(?P<line>\d+)|, line (?P<at>\d+))?: (?:(?P<key>[\w.:\[\]-]+): )?")


class Place(NamedTuple):
    """Where a sentence points to; None where it says nothing of it."""

    file: Optional[str]
    line: Optional[int]
    key: Optional[str]


class InputError(ValueError):
    """Unusable input: a config, a recording, an argument. All mistakes of a config are told at once."""

    @property
    def sentences(self) -> List[str]:
        """One a mistake: file, line, key, found, expected."""
        return str(self).splitlines()

    @property
    def places(self) -> List[Place]:
        """File, line and key of each sentence."""
        found = [_PLACE.match(sentence) for sentence in self.sentences]
        return [Place(m["file"], int(m["line"] or m["at"]) if m["line"] or m["at"] else None, m["key"]) if m
                else Place(None, None, None) for m in found]


def file_there(path: object) -> InputError:
    """A file that would be lost where another is written."""
    return InputError(f"{path}: found a file there, expected none: give another name, or replace it by --force (write: replace=True)")


class DiagnosisStopped(RuntimeError):
    """A diagnosis was cancelled before anything was known."""


class AxisRefused(RuntimeError):
    """A served axis did not obey; its own sentence says why."""


class FleetStopped(RuntimeError):
    """A fleet ended before all its recordings were done; its sentence says what is kept, and where."""
