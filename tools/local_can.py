# The local socket that stands in for a CAN bus (unix:PATH, hal/can/local_bus.hpp) as an interface of python-can.
import select, socket, struct, time

import can

FRAME = struct.Struct("=IB3x8s")  # struct can_frame
EXTENDED, REMOTE, ERROR = 0x80000000, 0x40000000, 0x20000000


class LocalCan(can.BusABC):
    """The side that connects."""

    def __init__(self, path, patience_s=20.0):
        end = time.monotonic() + patience_s
        while True:
            self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            try:
                self.socket.connect(path)
                break
            except OSError:
                self.socket.close()
                if time.monotonic() > end:
                    raise
                time.sleep(0.05)
        super().__init__(channel=path)
        self.channel_info = "unix:" + path

    def send(self, msg, timeout=None):
        word = msg.arbitration_id | (EXTENDED if msg.is_extended_id else 0) | (REMOTE if msg.is_remote_frame else 0)
        self.socket.send(FRAME.pack(word, msg.dlc, bytes(msg.data).ljust(8, b"\0")))

    def _recv_internal(self, timeout):
        if not select.select([self.socket], [], [], timeout)[0]:
            return None, False
        frame = self.socket.recv(FRAME.size)
        if len(frame) < FRAME.size:
            raise can.CanOperationError("the bus is gone")
        word, length, data = FRAME.unpack(frame)
        return can.Message(timestamp=time.time(), arbitration_id=word & 0x1FFFFFFF, is_extended_id=bool(word & EXTENDED),
                           is_remote_frame=bool(word & REMOTE), is_error_frame=bool(word & ERROR), dlc=length,
                           data=data[:length]), False

    def shutdown(self):
        super().shutdown()
        self.socket.close()
