# A serial CAN adapter (LAWICEL text) on a pseudo-terminal behind the kernel's slcan driver, bridged to another interface;
# it can tell the driver that its controller went bus-off.
import fcntl, os, select, socket, struct, subprocess, threading, tty

TIOCSETD, SIOCGIFNAME, N_SLCAN = 0x5423, 0x8910, 17
FRAME = struct.Struct("=IB3x8s")


class SerialAdapter:
    def __init__(self, other):
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        fcntl.ioctl(self.slave, TIOCSETD, struct.pack("i", N_SLCAN))
        self.name = fcntl.ioctl(self.slave, SIOCGIFNAME, b"\0" * 16).split(b"\0")[0].decode()
        self.bus = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.bus.bind((other,))
        self.passes = True        # frames go both ways
        self.heard = []           # identifiers of the frames that the driver sent, in order
        self.text = b""
        self.ends = False
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def up(self):
        subprocess.run(f"ip link set {self.name} type can bitrate 1000000; ip link set {self.name} txqueuelen 16 up",
                       shell=True, check=True)
        return self

    def down(self):
        subprocess.run(f"ip link set {self.name} down", shell=True, check=True)

    def say(self, text):
        os.write(self.master, text)

    def bus_off(self):
        """As an adapter reports it: state b, 255 errors. Number of frames heard before."""
        self.passes = False
        heard = len(self.heard)
        self.say(b"sb255000\r")
        return heard

    def run(self):
        while not self.ends:
            ready, _, _ = select.select([self.master, self.bus], [], [], 0.2)
            if self.master in ready:
                self.from_driver(os.read(self.master, 4096))
            if self.bus in ready:
                number, length, data = FRAME.unpack(self.bus.recv(16))
                if self.passes:
                    self.say(b"t%03X%d%s\r" % (number & 0x7FF, length, data[:length].hex().upper().encode()))

    def from_driver(self, text):
        *lines, self.text = (self.text + text).split(b"\r")
        for line in lines:
            if line[:1] != b"t":
                continue
            number, length = int(line[1:4], 16), int(line[4:5])
            self.heard.append(number)
            if self.passes:
                self.bus.send(FRAME.pack(number, length, bytes.fromhex(line[5:5 + 2 * length].decode())))

    def close(self):
        self.ends = True
        self.thread.join()
        os.close(self.slave)
        os.close(self.master)
        self.bus.close()
