# What the scripts that run the program share: the program, a check with a sentence, small edits of configs.
import os, re, subprocess, sys, time, zlib

CONFIG = "config/cylinder-10m-7.65mm.yaml"
program = os.path.join(sys.argv[1], "pneuservo")


def run(*arguments, **options):
    return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=300, **options)


def expect(condition, what):
    if not condition:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {what}")


def expect_refusal(done, words, what):
    """Exit status 2, one sentence on standard error with all the words, nothing on standard output."""
    said = done.stderr.strip()
    expect(done.returncode == 2, f"{what}: status {done.returncode}: {said}")
    expect(len(said.splitlines()) == 1, f"{what}: not one sentence: {said}")
    expect(all(word in said for word in words), f"{what}: {words} are not all in: {said}")
    expect(done.stdout == "", f"{what}: something was printed as a result: {done.stdout}")


def wait_until(holds, what, within_s=60.0):
    """Looks until it holds: what a loaded machine delays is no failure."""
    end = time.monotonic() + within_s
    while not holds():
        expect(time.monotonic() < end, f"{what}: not within {within_s:g} s")
        time.sleep(0.02)


def catches(process, number):
    """Whether the process has a handler for the signal by now."""
    with open(f"/proc/{process.pid}/status") as file:
        return int(re.search(r"SigCgt:\s+(\w+)", file.read()).group(1), 16) >> (number - 1) & 1 == 1


def size_so_far(path):
    """Bytes of a file, 0 while there is none; the program tries whether it can create one and takes it away again."""
    try:
        return os.path.getsize(path)
    except FileNotFoundError:
        return 0


def rows_so_far(record):
    """Rows of a recording as far as it is on the disk, the first with the names of the columns."""
    try:
        with open(record, "rb") as file:
            lines = zlib.decompressobj(31).decompress(file.read()).decode().splitlines()[:-1]
    except FileNotFoundError:
        return []
    return [line.split(",") for line in lines if not line.startswith("#")]


def edited_config(folder, pattern, replacement):
    """A copy of CONFIG with one place changed, and the line's number."""
    with open(CONFIG) as file:
        text = file.read()
    place = re.search(pattern, text, re.MULTILINE)
    path = os.path.join(folder, "edited.yaml")
    with open(path, "w") as file:
        file.write(text[:place.start()] + replacement + text[place.end():])
    return path, text[:place.start()].count("\n") + 1
