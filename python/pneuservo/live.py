# Live client of the verb serve: JSON lines over its Unix socket.
"""An axis that `pneuservo serve` runs, commanded from Python (docs/serve.md has the words and the protocol)."""
import json
import os
import socket
from typing import Any, Dict, Iterator, Union

from .errors import AxisRefused

PROTOCOL_VERSION = 1


class Axis:
    """A connection to a served axis; `with Axis("axis.sock") as axis: axis.enable(); axis.move_to(0.1)`.

    Whoever commands first is the commander until it releases the axis or its connection ends; leaving the `with`
    releases. One connection is for one thread.
    """

    def __init__(self, path: Union[str, "os.PathLike[str]"], timeout_s: float = 5.0) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.settimeout(timeout_s)
        try:
            self._socket.connect(os.fspath(path))
        except OSError as error:
            self._socket.close()
            raise ConnectionError(f"{path}: found no axis there ({error.strerror or error}), expected the socket of 'pneuservo serve'") from error
        self._received = b""
        self._id = 0

    @staticmethod
    def _plain(value: Any) -> Any:
        """numpy's numbers as Python's."""
        if hasattr(value, "tolist"):
            return value.tolist()
        raise TypeError(f"found {type(value).__name__} in a request, expected numbers and text")

    def ask(self, command: str, **keys: Any) -> Dict[str, Any]:
        """One request and its answer. Raises AxisRefused with the axis's sentence where it does not obey."""
        self._id += 1
        request = {"version": PROTOCOL_VERSION, "id": self._id, "command": command, **keys}
        self._socket.sendall(json.dumps(request, allow_nan=False, default=self._plain).encode() + b"\n")
        while True:
            answer = self._next()
            if answer.get("id") == self._id or ("id" not in answer and "status" not in answer):
                break
        if not answer.get("ok", False):
            raise AxisRefused(answer.get("error", "the axis refused and did not say why"))
        return answer

    def _next(self) -> Dict[str, Any]:
        while b"\n" not in self._received:
            try:
                more = self._socket.recv(65536)
            except socket.timeout as error:
                raise TimeoutError(f"no answer came within {self._socket.gettimeout():g} s, expected one: does the axis run?") from error
            if not more:
                raise ConnectionError("the axis ended the connection, expected an answer")
            self._received += more
        line, self._received = self._received.split(b"\n", 1)
        try:
            answer = json.loads(line)
        except ValueError as error:
            raise ConnectionError(f"found {line[:60]!r}, expected an answer of 'pneuservo serve', an object of JSON") from error
        if not isinstance(answer, dict):
            raise ConnectionError(f"found {line[:60]!r}, expected an answer of 'pneuservo serve', an object of JSON")
        return answer

    def enable(self) -> Dict[str, Any]:
        """The edge without which nothing moves."""
        return self.ask("enable")

    def disable(self) -> Dict[str, Any]:
        """Safe output."""
        return self.ask("disable")

    def reset(self) -> Dict[str, Any]:
        """Acknowledges a fault."""
        return self.ask("reset")

    def move_to(self, position_m: float, **keys: float) -> Dict[str, Any]:
        """To a place [m]; speed_mps [m/s]. The answer's ends_s says when the set point rests."""
        return self.ask("move_to", position_m=position_m, **keys)

    def move_by(self, way_m: float, **keys: float) -> Dict[str, Any]:
        """A way [m] from the target in force; speed_mps [m/s]."""
        return self.ask("move_by", way_m=way_m, **keys)

    def jog(self, speed_mps: float) -> Dict[str, Any]:
        """At a speed with its sign [m/s], to the end of the range."""
        return self.ask("jog", speed_mps=speed_mps)

    def follow(self, position_m: float, interval_s: float) -> Dict[str, Any]:
        """The next set point of a stream [m], so long after the last [s]."""
        return self.ask("follow", position_m=position_m, interval_s=interval_s)

    def stop(self) -> Dict[str, Any]:
        """To rest within the limits."""
        return self.ask("stop")

    def hold(self) -> Dict[str, Any]:
        """Rest; resume() goes on."""
        return self.ask("hold")

    def resume(self) -> Dict[str, Any]:
        """On to the held target."""
        return self.ask("resume")

    def mark(self) -> Dict[str, Any]:
        """Keeps the recording around now."""
        return self.ask("mark")

    def release(self) -> Dict[str, Any]:
        """Gives the axis to the next commander."""
        return self.ask("release")

    def status(self) -> Dict[str, Any]:
        """How the axis is, once."""
        return self.ask("status")

    def watch(self, interval_s: float) -> Iterator[Dict[str, Any]]:
        """How the axis is, every interval [s], until the loop over it ends."""
        yield self.ask("watch", interval_s=interval_s)
        while True:
            yield self._next()

    def close(self) -> None:
        """Ends the connection; a commander that did not release is then lost."""
        self._socket.close()

    def __enter__(self) -> "Axis":
        return self

    def __exit__(self, kind: Any, *_: Any) -> None:
        try:
            if kind is None:
                self.release()
        except (AxisRefused, OSError):
            pass  # somebody else commands, or the axis has gone: nothing is left to release
        finally:
            self.close()
