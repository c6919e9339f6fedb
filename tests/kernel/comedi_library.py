# comedilib for the scenarios, by ctypes: what stands at the other side of the board's terminals. comedi_test carries
# what output n is set to over to input n.
import ctypes

library = ctypes.CDLL("libcomedi.so.0")
library.comedi_open.restype = ctypes.c_void_p
library.comedi_get_maxdata.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_uint]
library.comedi_data_write.argtypes = [ctypes.c_void_p] + 5 * [ctypes.c_uint]
library.comedi_data_read.argtypes = [ctypes.c_void_p] + 4 * [ctypes.c_uint] + [ctypes.POINTER(ctypes.c_uint)]
library.comedi_close.argtypes = [ctypes.c_void_p]
INPUTS, OUTPUTS, SPAN_V = 0, 1, 10.0


class Board:
    def __init__(self, path=b"/dev/comedi0"):
        self.device = library.comedi_open(path)
        if not self.device:
            raise OSError("comedi_open")
        self.last = library.comedi_get_maxdata(self.device, OUTPUTS, 0)

    def write(self, channel, volts):
        code = round((volts + SPAN_V) / (2 * SPAN_V) * self.last)
        if library.comedi_data_write(self.device, OUTPUTS, channel, 0, 0, max(0, min(self.last, code))) != 1:
            raise OSError("comedi_data_write")

    def read(self, channel):
        code = ctypes.c_uint()
        if library.comedi_data_read(self.device, INPUTS, channel, 0, 0, ctypes.byref(code)) != 1:
            raise OSError("comedi_data_read")
        return code.value / self.last * 2 * SPAN_V - SPAN_V

    def close(self):
        library.comedi_close(self.device)
