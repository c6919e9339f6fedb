#!/usr/bin/env python3
# EDS and DCF files drawn with what real ones have: types, access, mapping, defaults and values as drawn, and as python-canopen
# reads them.
import os, random, struct, subprocess, sys, tempfile

from canopen_env import with_canopen

with_canopen()
import canopen  # noqa: E402
from canopen.objectdictionary import ODArray, ODVariable  # noqa: E402

SEED = int(os.environ.get("PNEUSERVO_TEST_SEED", random.randrange(1 << 30)))
FILES = 150
draw = random.Random(SEED)
reader = os.path.join(sys.argv[1], "tests", "eds_entries")
folder = tempfile.TemporaryDirectory()

# Data type of CiA 301: how struct packs it, and bits.
WHOLE = {0x01: ("?", 1), 0x02: ("b", 8), 0x03: ("h", 16), 0x04: ("i", 32), 0x05: ("B", 8), 0x06: ("H", 16), 0x07: ("I", 32),
         0x15: ("q", 64), 0x1B: ("Q", 64)}
REAL = {0x08: "f", 0x11: "d"}
TEXT, OCTETS, DOMAIN = 0x09, 0x0A, 0x0F


def any_case(text):
    return draw.choice([text, text.lower(), text.upper()])


def spelled(value, bits, node):
    """A whole number as files have it; `value` is what it comes to."""
    forms = [str(value)]
    if value >= 0:
        forms += [f"0x{value:X}", f"0x{value:x}", f"0x{value:08X}"]
    if bits >= 16 and value >= node:
        forms += [f"$NODEID+0x{value - node:X}", f"0x{value - node:x}+$NODEID", f"$NODEID+{value - node}"]
    return draw.choice(forms)


def number(kind):
    form, bits = WHOLE[kind]
    if bits == 1:
        return draw.randrange(2)
    signed = form.islower()
    lowest = -(1 << (bits - 1)) if signed else 0
    most = (1 << (bits - 1)) - 1 if signed else (1 << bits) - 1
    return draw.choice([lowest, most, 0, 1, draw.randrange(lowest, most + 1)])


def value(kind, node):
    """Text of a value and the bytes that it stands for."""
    if kind in WHOLE:
        one = number(kind)
        return spelled(one, WHOLE[kind][1], node), struct.pack("<" + WHOLE[kind][0], one)
    if kind in REAL:
        one = draw.choice([1.5, -2.0, 0.0, 3e-5, draw.gauss(0, 1e3)])
        return repr(one), struct.pack("<" + REAL[kind], one)
    if kind == TEXT:
        text = draw.choice(["valve 3/2", "a;b", "x", "Druck p1"])
        return text, text.encode()
    data = bytes(draw.randrange(256) for _ in range(draw.randrange(1, 9)))
    return draw.choice([data.hex(), data.hex(" ")]), data


def entry(node, is_dcf, kinds):
    kind = draw.choice(kinds)
    access = draw.choice(["ro", "rw", "wo", "rww", "rwr", "const"])
    mapping = draw.choice(["0", "1", "0x1", None]) if kind in WHOLE else draw.choice(["0", None])
    out = {"kind": kind, "read": access != "wo", "write": "w" in access, "map": mapping in ("1", "0x1"), "standard": b"", "value": b""}
    lines = [f"ParameterName=entry", f"ObjectType=0x7",
             f"DataType={draw.choice([f'0x{kind:04X}', f'0x{kind:x}', str(kind)])}", f"AccessType={any_case(access)}"]
    if mapping is not None:
        lines.append(f"PDOMapping={mapping}")
    if kind != DOMAIN and draw.random() < 0.7:
        text, out["standard"] = value(kind, node)
        lines.append(f"DefaultValue{draw.choice(['=', ' = '])}{text}")
    if kind != DOMAIN and is_dcf and draw.random() < 0.6:
        text, out["value"] = value(kind, node)
        lines.append(f"ParameterValue={text}")
    draw.shuffle(lines)
    return lines, out


def drawn_file(node, is_dcf):
    """Lines of a file, its entries by index and sub-index, and those that no line states: counts of arrays in one section."""
    unstated = set()
    lines, entries = ["; drawn", "[DeviceInfo]", "VendorName=Somebody", f"VendorNumber=0x{draw.randrange(1 << 32):X}", "ProductNumber=7"], {}
    if is_dcf:
        lines += ["[DeviceComissioning]", f"NodeID={node}", "Baudrate=1000"]
    indices = draw.sample([i for i in range(0x1000, 0xA000) if not 0x1003 <= i <= 0x1017], 12)
    all_kinds = [*WHOLE, *REAL, TEXT, OCTETS, DOMAIN]
    for index in indices:
        section = draw.choice([f"{index:04X}", f"{index:04x}"])
        kind = draw.choice(["variable", "array", "record", "compact"])
        lines.append(draw.choice(["", "; a remark", "# another"]))
        if kind == "variable":
            own, entries[index, 0] = entry(node, is_dcf, all_kinds)
            lines += [f"[{section}]", *own]
        elif kind == "compact":
            count, member = draw.randrange(1, 5), draw.choice([*WHOLE])
            lines += [f"[{section}]", "ParameterName=alike", "ObjectType=0x8", f"DataType=0x{member:04X}", "AccessType=ro", "PDOMapping=1",
                      f"CompactSubObj={count}"]
            unstated.add((index, 0))
            entries[index, 0] = {"kind": 5, "read": True, "write": False, "map": False, "standard": bytes([count]), "value": b""}
            for sub in range(1, count + 1):
                entries[index, sub] = {"kind": member, "read": True, "write": False, "map": True, "standard": b"", "value": b""}
        else:
            count = draw.randrange(1, 4)
            lines += [f"[{section}]", f"ParameterName={kind}", f"ObjectType={'0x8' if kind == 'array' else '0x9'}", f"SubNumber={count + 1}"]
            for sub in range(count + 1):
                own, one = entry(node, is_dcf, [5] if sub == 0 else all_kinds)
                entries[index, sub] = one
                lines += [f"[{section}{draw.choice(['sub', 'Sub'])}{sub:{draw.choice(['X', 'x'])}}]", *own]
    return lines, entries, unstated


def as_bytes(kind, read):
    """What python-canopen read, as the bytes of the type."""
    if read is None or read == "":
        return b""
    if kind in WHOLE:
        return struct.pack("<" + WHOLE[kind][0], read)
    if kind in REAL:
        return struct.pack("<" + REAL[kind], read)
    return read.encode() if isinstance(read, str) else bytes(read)


def by_canopen(path, node):
    entries = {}
    dictionary = canopen.import_od(path, node)
    for index, found in dictionary.items():
        members = {0: found} if isinstance(found, ODVariable) else dict(found.items())
        if isinstance(found, ODArray):
            members = {sub: found[sub] for sub in members}
        for sub, one in members.items():
            entries[index, sub] = {"kind": one.data_type, "read": one.readable, "write": one.writable, "map": bool(one.pdo_mappable),
                                   "standard": as_bytes(one.data_type, one.default), "value": as_bytes(one.data_type, one.value)}
    return entries


def by_program(path, node):
    done = subprocess.run([reader, path, str(node)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{path}: {done.stderr}"
    entries = {}
    for line in done.stdout.splitlines():
        index, sub, kind, can_map, can_read, can_write, standard, configured = line.split(",")
        if kind == "0":
            continue  # the head of an array or record
        entries[int(index, 16), int(sub)] = {"kind": int(kind), "read": can_read == "1", "write": can_write == "1", "map": can_map == "1",
                                             "standard": bytes.fromhex(standard), "value": bytes.fromhex(configured)}
    return entries


print(f"seed {SEED} (PNEUSERVO_TEST_SEED)")
compared = 0
for count in range(FILES):
    node, is_dcf = draw.randrange(1, 128), draw.random() < 0.5
    lines, drawn, unstated = drawn_file(node, is_dcf)
    path = os.path.join(folder.name, f"{count}.{'dcf' if is_dcf else 'eds'}")
    with open(path, "w", encoding="ascii", newline="") as file:
        file.write(draw.choice(["\n", "\r\n"]).join(lines) + "\n")
    own, other = by_program(path, node), by_canopen(path, node)
    assert own.keys() == drawn.keys(), f"file {count}: entries {sorted(own.keys() ^ drawn.keys())}"
    for place, one in drawn.items():
        what = f"file {count}, 0x{place[0]:04X} sub {place[1]} of\n" + "\n".join(lines)
        assert own[place] == one, f"{what}\nread {own[place]}\nfor  {one}"
        # Of an array in one section python-canopen has the first member, and makes the others when they are asked for.
        if place in other and place not in unstated:
            assert own[place] == other[place], f"{what}\nread {own[place]}\npython-canopen {other[place]}"
            compared += 1
assert compared > 10 * FILES, compared
print(f"{FILES} files, {compared} entries as python-canopen reads them")
