# Recordings as MCAP: whole chunks at a time, for a call a message takes longer than everything else.
"""The layout of the records is that of https://mcap.dev/spec; those that come once are written and read by the package mcap."""
import os
import struct
import zlib
from typing import Any, Dict, Iterator, List, Optional, Tuple, Union

import numpy
import zstandard
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.reader import NonSeekingReader, make_reader
from mcap.records import (Channel, Chunk, ChunkIndex, DataEnd, Footer, Header, McapRecord, Metadata, MetadataIndex, Schema,
                          Statistics)
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

from .errors import InputError

Path = Union[str, "os.PathLike[str]"]
TOPIC = "/recording"
CHUNK_BYTES = 4 << 20
# A message is a row; Foxglove and PlotJuggler read this encoding as they do a ROS 2 bag. CDR begins with four bytes
# that say little endian, and aligns what follows from there on.
_CDR_HEADER = b"\x00\x01\x00\x00"
_RECORD_HEADER = struct.Struct("<BQ")  # opcode, length of what follows
# What the packages throw where bytes are wrong: of sizes, places, names and check sums. RuntimeError is lz4's.
_DAMAGE = (McapError, zstandard.ZstdError, struct.error, ValueError, KeyError, OSError, OverflowError, MemoryError, RuntimeError)


def _message(columns: int) -> numpy.dtype:
    """A record of kind message that holds so many float64."""
    return numpy.dtype([("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8"),
                        ("publish_time", "<u8"), ("cdr", "u1", (len(_CDR_HEADER),)), ("row", "<f8", (columns,))])


def _data_place(kind: numpy.dtype) -> int:
    """Where in such a record the message's data begin."""
    return kind.fields["cdr"][1]


def _bytes_of(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())


def _chunk(head: bytes, messages: numpy.ndarray, begin: int) -> Tuple[bytes, ChunkIndex]:
    """Chunk and message index as they stand from byte `begin` of the file on, and what the summary says of them."""
    data = head + messages.tobytes()
    times = messages["log_time"]
    chunk = Chunk(compression="zstd", data=zstandard.compress(data), message_start_time=int(times.min()),
                  message_end_time=int(times.max()), uncompressed_crc=zlib.crc32(data), uncompressed_size=len(data))
    record = _bytes_of(chunk)
    entries = numpy.empty((len(messages), 2), dtype="<u8")
    entries[:, 0] = times
    entries[:, 1] = len(head) + messages.itemsize * numpy.arange(len(messages))
    index = (_RECORD_HEADER.pack(Opcode.MESSAGE_INDEX, 6 + entries.nbytes) + struct.pack("<HI", 1, entries.nbytes) + entries.tobytes())
    return record + index, ChunkIndex(
        message_start_time=chunk.message_start_time, message_end_time=chunk.message_end_time, chunk_start_offset=begin,
        chunk_length=len(record), message_index_offsets={1: begin + len(record)}, message_index_length=len(index),
        compression=chunk.compression, compressed_size=len(chunk.data), uncompressed_size=len(data))


def _chunks(columns: Dict[str, numpy.ndarray]) -> Iterator[numpy.ndarray]:
    """The rows as messages of channel 1, a chunk at a time."""
    kind = _message(len(columns))
    stamps = numpy.round(columns["t_s"] * 1e9).astype(numpy.int64)
    stamps -= min(int(stamps[0]), 0)  # of MCAP they count from 0; the times themselves are a column
    rows = max(1, CHUNK_BYTES // kind.itemsize)
    for begin in range(0, len(stamps), rows):
        some = slice(begin, begin + rows)
        messages = numpy.empty(len(stamps[some]), kind)
        messages["opcode"], messages["length"] = Opcode.MESSAGE, kind.itemsize - _RECORD_HEADER.size
        messages["channel"], messages["sequence"] = 1, 0
        messages["log_time"] = messages["publish_time"] = stamps[some]
        messages["cdr"] = list(_CDR_HEADER)
        for number, values in enumerate(columns.values()):
            messages["row"][:, number] = values[some]
        yield messages


def write(columns: Dict[str, numpy.ndarray], units: List[str], about: str, library: str, path: Path) -> None:
    """Columns with t_s [s] by names that ROS 2 takes, whose units stand in the schema; `about` is text beside them."""
    text = "".join(f"float64 {name}  # {unit or '-'}\n" for name, unit in zip(columns, units))
    schema = Schema(id=1, name="pneuservo/msg/Row", encoding="ros2msg", data=text.encode())
    channel = Channel(id=1, topic=TOPIC, message_encoding="cdr", schema_id=1, metadata={})
    with open(path, "wb") as file:
        file.write(MCAP0_MAGIC + _bytes_of(Header("ros2", library)))
        metadata = _bytes_of(Metadata(name="pneuservo", metadata={"about": about}))
        metadata_index = MetadataIndex(offset=file.tell(), length=len(metadata), name="pneuservo")
        file.write(metadata)
        indexes: List[ChunkIndex] = []
        head = _bytes_of(schema, channel)
        for messages in _chunks(columns):
            data, index = _chunk(head, messages, file.tell())
            file.write(data)
            indexes.append(index)
            head = b""
        file.write(_bytes_of(DataEnd(0)))
        rows = len(columns["t_s"])
        statistics = Statistics(attachment_count=0, channel_count=1, channel_message_counts={1: rows}, chunk_count=len(indexes),
                                message_count=rows, metadata_count=1, schema_count=1,
                                message_start_time=min(one.message_start_time for one in indexes),
                                message_end_time=max(one.message_end_time for one in indexes))
        begin = file.tell()
        summary = _bytes_of(schema, channel, statistics, *indexes, metadata_index)
        # Its check sum takes in the footer up to itself.
        checked = summary + _RECORD_HEADER.pack(Opcode.FOOTER, 20) + struct.pack("<QQ", begin, 0)
        footer = Footer(summary_start=begin, summary_offset_start=0, summary_crc=zlib.crc32(checked))
        file.write(summary + _bytes_of(footer) + MCAP0_MAGIC)


def _names_of(schema: Optional[Schema], path: Path) -> List[str]:
    """The columns that a schema has; without one none are known."""
    if schema is None:
        raise InputError(f"{path}: found no schema of {TOPIC}, expected one with float64 fields")
    names = []
    for line in schema.data.decode(errors="replace").splitlines():
        words = line.split("#")[0].split()
        if len(words) == 2 and words[0] == "float64":
            names.append(words[1])
        elif words:
            raise InputError(f"{path}: found '{line.strip()}' in the schema of {TOPIC}, expected float64 fields alone")
    return names


def _require_length(found: int, kind: numpy.dtype, path: Path) -> None:
    """Of a message's data: a row and what begins it."""
    expected = kind.itemsize - _data_place(kind)
    if found != expected:
        raise InputError(f"{path}: found a message of {found} bytes in {TOPIC}, expected {expected}, those of its schema")


def _rows_in(data: bytes, channels: List[int], kind: numpy.dtype, path: Path) -> Iterator[numpy.ndarray]:
    """The rows of these channels among the records of a chunk; equal neighbours are taken together."""
    at, ahead = 0, 1
    while at < len(data):
        opcode, length = _RECORD_HEADER.unpack_from(data, at)
        if at + _RECORD_HEADER.size + length > len(data):
            raise EndOfFile
        if opcode != Opcode.MESSAGE or struct.unpack_from("<H", data, at + _RECORD_HEADER.size)[0] not in channels:
            at, ahead = at + _RECORD_HEADER.size + length, 1
            continue
        _require_length(_RECORD_HEADER.size + length - _data_place(kind), kind, path)
        some = numpy.frombuffer(data, kind, min(ahead, (len(data) - at) // kind.itemsize), at)
        alike = (some["opcode"] == opcode) & (some["length"] == length) & numpy.isin(some["channel"], channels)
        count = len(some) if alike.all() else int(alike.argmin())
        yield some["row"][:count]
        at, ahead = at + count * kind.itemsize, 2 * ahead if count == len(some) else 1


def _parts_by_index(file: Any, summary: Any, channels: List[int], kind: numpy.dtype, path: Path) -> Iterator[numpy.ndarray]:
    for index in sorted(summary.chunk_indexes, key=lambda one: one.chunk_start_offset):
        file.seek(index.chunk_start_offset + _RECORD_HEADER.size)
        stream, size = get_chunk_data_stream(Chunk.read(ReadDataStream(file)), validate_crc=True)
        yield from _rows_in(stream.read(size), channels, kind, path)


def _content(file: Any, path: Path) -> Tuple[List[str], List[numpy.ndarray], str]:
    """Names and rows of the columns, and the text beside them."""
    reader = make_reader(file)
    about = next((m.metadata.get("about", "{}") for m in reader.iter_metadata() if m.name == "pneuservo"), "{}")
    summary = reader.get_summary()
    channels = [one for one in summary.channels.values() if one.topic == TOPIC] if summary and summary.chunk_indexes else []
    schema = summary.schemas.get(channels[0].schema_id) if channels else None
    if schema is not None:
        names = _names_of(schema, path)
        ids = [one.id for one in channels]
        return names, list(_parts_by_index(file, summary, ids, _message(len(names)), path)), about
    names, parts = [], []  # without an index, a message at a time
    file.seek(0)
    for schema, _, message in NonSeekingReader(file, validate_crcs=True).iter_messages([TOPIC], log_time_order=False):
        names = names or _names_of(schema, path)
        _require_length(len(message.data), _message(len(names)), path)
        parts.append(numpy.frombuffer(message.data, "<f8", offset=len(_CDR_HEADER)).reshape(1, -1))
    return names, parts, about


def read(path: Path) -> Tuple[Dict[str, numpy.ndarray], str]:
    """Columns and the text beside them, as write() took them; of other programs' files the topic /recording."""
    with open(path, "rb") as file:
        try:
            names, parts, about = _content(file, path)
        except InputError:
            raise
        except _DAMAGE as error:
            raise InputError(f"{path}: found a file that is damaged or no MCAP ({str(error) or type(error).__name__}), "
                             "expected one with whole records and right check sums") from error
    if not parts:
        raise InputError(f"{path}: found no messages of {TOPIC}, expected a recording that was exported as MCAP")
    return {name: numpy.concatenate([part[:, i] for part in parts]) for i, name in enumerate(names)}, about
