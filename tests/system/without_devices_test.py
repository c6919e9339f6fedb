#!/usr/bin/env python3
# The program without libgpiod, comedilib and libiio: configured so, said so, compiled, and refusing what would need them.
import os, pathlib, subprocess, sys, tempfile

sys.dont_write_bytecode = True
from link_again import compile_flags, libraries
from program import expect

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1]).resolve()
folder = pathlib.Path(tempfile.mkdtemp())


def must(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=600)
    expect(done.returncode == 0, f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


said = must("cmake", "-S", SOURCE, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O0", "-DPNEUSERVO_BUILD_TESTS=OFF",
            "-DPNEUSERVO_WITH_GPIO=OFF", "-DPNEUSERVO_WITH_COMEDI=OFF", "-DPNEUSERVO_WITH_IIO=OFF", "-DPNEUSERVO_WARNINGS_AS_ERRORS=ON")
for package, section in (("libgpiod-dev", "gpio"), ("libcomedi-dev", "comedi"), ("libiio-dev", "iio")):
    expect(f"without {package}: the program will refuse configs with hal.{section}" in said, f"configure does not say that {package} is left out: {said}")
link = (folder / "build.ninja").read_text().split("\nbuild pneuservo: CXX_EXECUTABLE")[1].split("\nbuild ")[0]
expect("gpiod" not in link and "comedi" not in link and "libiio" not in link, f"linked all the same: {link}")

# The sources that the options choose between; all others are compiled as ever.
objects = [f"hal/CMakeFiles/pneuservo_hal.dir/{name}.cpp.o" for name in ("gpio/gpio_absent", "gpio/libgpiod_1", "comedi/comedi_absent", "comedi/comedi_board",
                                                                        "iio/iio_absent", "iio/iio_board", "iio/iio_scan")]
must("ninja", "-C", folder, "-j", os.cpu_count(), *objects)
compiler, _ = compile_flags(BUILD, "src/program/main.cpp")
must(compiler, BUILD / "src/CMakeFiles/pneuservo.dir/program/main.cpp.o", *(folder / name for name in objects), *libraries(BUILD), "-o", folder / "pneuservo")

DEVICES = {"config/comedi/cylinder-10m-7.65mm.yaml": "built without comedilib: install libcomedi-dev and build it again",
           "config/iio/cylinder-10m-7.65mm.yaml": "built without libiio: install libiio-dev and build it again",
           "config/mixed/cylinder-10m-7.65mm.yaml": "install lib"}
for config, words in DEVICES.items():
    done = subprocess.run([folder / "pneuservo", "run", config, "--time", "real", "--duration-s", "0.1"], capture_output=True, text=True, timeout=60)
    expect(done.returncode not in (0, None) and words in done.stderr, f"{config}: status {done.returncode}: {done.stdout}{done.stderr}")
simulated = subprocess.run([folder / "pneuservo", "run", "config/cylinder-10m-7.65mm.yaml", "--duration-s", "0.1"], capture_output=True, text=True, timeout=60)
expect(simulated.returncode == 0, f"a simulated run: {simulated.stderr}")
