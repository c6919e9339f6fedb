# Recordings: files, arrays, pandas, foreign loggers, and the formats of other programs, equal to the last bit.
import io
import os
import struct
import warnings
import zlib

import numpy
import pytest

import pneuservo


def same(a, b):
    return numpy.array_equal(numpy.asarray(a).view(numpy.uint64), numpy.asarray(b).view(numpy.uint64))


def test_a_written_recording_reads_back_to_the_bit(config, swept, tmp_path):
    path = str(tmp_path / "run.csv.gz")
    swept.write(path, config)
    again, = pneuservo.read_recordings(path, config)
    assert again.rig == config.name and again.period_s == config.period_s
    assert again.header["config"].startswith("# Rig")
    for name in swept.keys():
        assert same(again[name], swept[name]), name
    with pytest.raises(pneuservo.InputError, match="run.csv.gz"):
        swept.write(path, config)


def test_pandas_and_back(config, swept):
    pandas = pytest.importorskip("pandas")
    frame = pneuservo.to_pandas(swept)
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns) == list(swept.keys())
    again = pneuservo.recording_of(frame, config)
    assert same(again["x_m"], swept["x_m"])


def test_mistakes_of_recordings_are_named(tmp_path):
    with pytest.raises(pneuservo.InputError, match="t_s"):
        pneuservo.Recording({"x_m": numpy.zeros(3)})
    with pytest.raises(ValueError, match="x_m: found 2 rows, expected 3 as t_s has"):
        pneuservo.Recording({"t_s": numpy.arange(3.0), "x_m": numpy.zeros(2)})
    with pytest.raises(pneuservo.InputError, match="nowhere.csv.gz"):
        pneuservo.read_recordings(tmp_path / "nowhere.csv.gz")
    recording = pneuservo.Recording({"t_s": numpy.arange(3.0)})
    with pytest.raises(KeyError, match="x_m"):
        recording["x_m"]


def test_a_foreign_file_by_the_importer(tmp_path):
    file = tmp_path / "logger.csv"
    rows = "\n".join(f"{10 * i},{i / 7:.4f},{1.5 + i / 100:.3f}" for i in range(50))
    file.write_text("time [ms],position [mm],p1 [bar]\n" + rows + "\n")
    result = pneuservo.import_recording(str(file))
    run = result.runs[0]
    assert run["t_s"][1] - run["t_s"][0] == pytest.approx(0.01)
    assert run["x_m"][7] == pytest.approx(1e-3)
    assert "import:" in result.section
    assert {c["taken_for"] for c in result.columns} >= {"t_s", "x_m"}


@pytest.mark.parametrize("suffix, packages", [(".parquet", ["pyarrow"]), (".mat", ["scipy"]), (".mcap", ["mcap"])])
def test_other_formats_come_back_to_the_bit(swept, tmp_path, suffix, packages):
    for package in packages:
        pytest.importorskip(package)
    from pneuservo import export

    columns = {name: numpy.array(swept[name]) for name in swept.keys()}
    columns["p_supply_Pa"][3] = numpy.nan  # no value
    columns["x_m"][4] = numpy.nextafter(0.1, 1.0)
    recording = pneuservo.Recording(columns, period_s=swept.period_s, rig="rig")
    path = tmp_path / f"run{suffix}"
    export.write(recording, path)
    again = export.read(path)
    assert again.period_s == swept.period_s and again.rig == "rig"
    assert list(again.keys()) == list(recording.keys())
    for name in recording.keys():
        assert same(again[name], recording[name]), name
    with pytest.raises(pneuservo.InputError, match="expected none"):
        export.write(recording, path)


def test_the_command_exports_and_says_what_it_cannot(config, swept, tmp_path, capsys):
    pytest.importorskip("scipy")
    from pneuservo import export

    swept.write(str(tmp_path / "run.csv.gz"), config)
    assert export.main([str(tmp_path / "run.csv.gz"), "--mat", "--out", str(tmp_path)]) == 0
    assert "written" in capsys.readouterr().out and (tmp_path / "run.mat").exists()
    assert export.main([str(tmp_path / "nowhere.csv.gz"), "--mat"]) == 2
    assert "nowhere.csv.gz" in capsys.readouterr().err


def test_mcap_says_its_schema_and_units(swept, tmp_path):
    reader = pytest.importorskip("mcap.reader")
    from pneuservo import export

    export.write(swept, tmp_path / "run.mcap")
    with open(tmp_path / "run.mcap", "rb") as file:
        schema, channel, message = next(iter(reader.make_reader(file).iter_messages()))
    assert "float64 p1_port_Pa  # Pa" in schema.data.decode()
    assert (channel.topic, channel.message_encoding, schema.encoding) == ("/recording", "cdr", "ros2msg")
    assert len(message.data) == 4 + 8 * len(swept.keys())


def message_times(content, one):
    """Of a chunk, by the index of its messages: each entry leads to a record that says the same time."""
    zstandard = pytest.importorskip("zstandard")
    from mcap.data_stream import ReadDataStream
    from mcap.records import Chunk, MessageIndex

    place = one.message_index_offsets[1]
    assert one.chunk_start_offset + one.chunk_length == place
    assert (content[one.chunk_start_offset], content[place]) == (0x06, 0x07)  # chunk, message index
    chunk = Chunk.read(ReadDataStream(io.BytesIO(content[one.chunk_start_offset + 9:place])))
    index = MessageIndex.read(ReadDataStream(io.BytesIO(content[place + 9:place + one.message_index_length])))
    data = zstandard.decompress(chunk.data)
    for time_ns, at in index.records:
        opcode, _, channel, _, log_time_ns = struct.unpack_from("<BQHIQ", data, at)
        assert (opcode, channel, log_time_ns) == (0x05, index.channel_id, time_ns)
    assert len({at for _, at in index.records}) == len(index.records)
    return [time_ns for time_ns, _ in index.records]


def test_an_mcap_of_ours_has_the_index_and_check_sums_that_others_read_by(config, tmp_path):
    """Several chunks, each found by its index, with the check sums of chunks and summary right."""
    reader = pytest.importorskip("mcap.reader")
    from pneuservo import export, mcap_file

    t_s = numpy.arange(100_000) * config.period_s - 0.5
    export.write(pneuservo.Recording({"t_s": t_s, "u_V": numpy.sin(t_s)}, period_s=config.period_s), tmp_path / "run.mcap")
    with open(tmp_path / "run.mcap", "rb") as file:
        seeking = reader.make_reader(file, validate_crcs=True)
        summary = seeking.get_summary()
        assert summary.statistics.message_count == len(t_s) and len(summary.chunk_indexes) > 1
        file.seek(0)
        content = file.read()
        footer = len(content) - 8 - 20  # behind its header of 9 bytes, before the magic
        begin, _, check_sum = struct.unpack_from("<QQI", content, footer)
        assert check_sum == zlib.crc32(content[begin:footer + 16])
        times_ns = [time_ns for one in summary.chunk_indexes for time_ns in message_times(content, one)]
        assert times_ns == numpy.round((t_s - t_s[0]) * 1e9).astype(int).tolist()
        # By the index: from the middle on, and only that.
        half_ns = 50_000_000_000
        found = [numpy.frombuffer(message.data[4:])[1] for _, _, message in seeking.iter_messages(starting_at=half_ns)]
    assert numpy.array_equal(found, numpy.sin(t_s[50_000:]))
    assert mcap_file.read(tmp_path / "run.mcap")[0]["u_V"].tolist() == numpy.sin(t_s).tolist()


@pytest.mark.parametrize("indexes, repeats", [("ALL", True), ("ALL", False), ("NONE", True)])
def test_an_mcap_of_another_program_gives_the_rows_of_its_topic(indexes, repeats, tmp_path):
    writer = pytest.importorskip("mcap.writer")
    from pneuservo import export

    rows = numpy.random.default_rng(3).normal(size=(400, 2))
    rows[:, 0] = numpy.arange(400) * 1e-3
    with open(tmp_path / "other.mcap", "wb") as file:
        out = writer.Writer(file, chunk_size=1 << 12, index_types=writer.IndexType[indexes],
                            repeat_channels=repeats, repeat_schemas=repeats)
        out.start()
        schema = out.register_schema(name="other/msg/Row", encoding="ros2msg", data=b"float64 t_s\nfloat64 u_V\n")
        text = out.register_channel(topic="/log", message_encoding="json", schema_id=0)
        row = out.register_channel(topic="/recording", message_encoding="cdr", schema_id=schema)
        for number, values in enumerate(rows):
            if number % 7 == 3:
                out.add_message(text, log_time=number, publish_time=number, data=b"x" * (number % 50))
            out.add_message(row, log_time=number, publish_time=number, data=b"\x00\x01\x00\x00" + values.tobytes())
        out.finish()
    again = export.read(tmp_path / "other.mcap")
    assert same(again["t_s"], rows[:, 0]) and same(again["u_V"], rows[:, 1])


def write_foreign(path, indexed, schema_id=1, crc=0, cut=0, row=16):
    """Two messages of so many bytes in a chunk of another program, whose last bytes are cut off."""
    from mcap.data_stream import RecordBuilder
    from mcap.records import Channel, Chunk, ChunkIndex, DataEnd, Footer, Header, Message, Schema
    from mcap.writer import MCAP0_MAGIC

    def written(*records):
        builder = RecordBuilder()
        for record in records:
            record.write(builder)
        return bytes(builder.end())

    described = [Schema(id=1, name="other/msg/Row", encoding="ros2msg", data=b"float64 t_s\nfloat64 u_V\n"),
                 Channel(id=1, topic="/recording", message_encoding="cdr", schema_id=schema_id, metadata={})]
    messages = [Message(channel_id=1, sequence=0, log_time=time, publish_time=time, data=bytes([0, 1, 0, 0]) + bytes([time] * row))
                for time in (1, 2)]
    data = written(*described, *messages)
    data = data[:len(data) - cut]
    chunk = Chunk(compression="", data=data, message_start_time=1, message_end_time=2, uncompressed_crc=crc, uncompressed_size=len(data))
    begin = MCAP0_MAGIC + written(Header("ros2", "other"))
    body = begin + written(chunk)
    index = ChunkIndex(message_start_time=1, message_end_time=2, chunk_start_offset=len(begin), chunk_length=len(body) - len(begin),
                       message_index_offsets={}, message_index_length=0, compression="", compressed_size=len(data),
                       uncompressed_size=len(data))
    body += written(DataEnd(0))
    summary = written(*described, index) if indexed else b""
    footer = written(Footer(summary_start=len(body) if indexed else 0, summary_offset_start=0, summary_crc=0))
    path.write_bytes(body + summary + footer + MCAP0_MAGIC)


@pytest.mark.parametrize("indexed", [True, False])
def test_a_foreign_or_damaged_mcap_is_refused_in_a_sentence(indexed, tmp_path):
    pytest.importorskip("mcap")
    from pneuservo import export

    path = tmp_path / "other.mcap"
    write_foreign(path, indexed)
    assert len(export.read(path)) == 2
    for wrong, words in (({"schema_id": 0}, "found no schema of /recording"), ({"crc": 1}, "crc validation failed in Chunk"),
                         ({"cut": 3}, "damaged" if indexed else "found a message of 17 bytes"),
                         ({"cut": 3, "schema_id": 0}, "found no schema of /recording"), ({"cut": 44}, "damaged"),
                         ({"row": 8}, "found a message of 12 bytes in /recording, expected 20"),
                         ({"row": 24}, "found a message of 28 bytes in /recording, expected 20")):
        write_foreign(path, indexed, **wrong)
        with pytest.raises(pneuservo.InputError, match=words) as refused:
            export.read(path)
        assert str(refused.value).startswith(f"{path}: ") and len(refused.value.sentences) == 1, wrong
    write_foreign(path, indexed)
    whole = path.read_bytes()
    for length in (0, 5, 8, 20, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        with pytest.raises(pneuservo.InputError, match="damaged or no MCAP"):
            export.read(path)


def test_rows_that_are_left_out_are_warned_of():
    with pytest.warns(UserWarning, match="t_s"):
        recording = pneuservo.Recording({"t_s": numpy.array([0.0, 0.1, 0.05, 0.2]), "u_V": numpy.arange(4.0)})
    assert len(recording) == 3


NAMES = ["t_s", "x_m", "T [C]", "größe", "1bad", "_under", "T_[C]", "end", "file", "about", "pneuservo", "a" * 80, "with, comma"]


@pytest.mark.parametrize("suffix, package", [(".parquet", "pyarrow"), (".mat", "scipy"), (".mcap", "mcap")])
def test_every_name_and_the_header_come_back(tmp_path, suffix, package):
    pytest.importorskip(package)
    from pneuservo import export

    text = 'format: pneuservo-recording/1\nrig: "a: b"\nperiod_s: 0.001\nconfig: |\n  # größe\n  name: x\nlist: [1, two, 3.5]\n'
    recording = pneuservo.Recording({name: (numpy.arange(3.0) + number) * 1e-3 for number, name in enumerate(NAMES)},
                                    period_s=1e-3, header_text=text)
    export.write(recording, tmp_path / f"run{suffix}")
    again, = pneuservo.read_recordings(tmp_path / f"run{suffix}")
    assert list(again.keys()) == NAMES and all(same(again[name], recording[name]) for name in NAMES)
    assert again.header == recording.header and again.header["list"] == [1, "two", 3.5] and again.header_text == text
    one = pneuservo.Recording({"t_s": numpy.zeros(1), "x_m": numpy.ones(1)})
    export.write(one, tmp_path / f"one{suffix}")
    assert export.read(tmp_path / f"one{suffix}")["x_m"].tolist() == [1.0]


@pytest.mark.parametrize("suffix, package", [(".parquet", "pyarrow"), (".mat", "scipy"), (".mcap", "mcap")])
def test_a_cut_file_is_told_and_a_failed_write_leaves_the_older_file(swept, tmp_path, suffix, package, monkeypatch):
    pytest.importorskip(package)
    from pneuservo import export

    path = tmp_path / f"run{suffix}"
    export.write(swept, path)
    whole = path.read_bytes()
    for cut in (b"", b"hello" * 50, whole[:len(whole) // 2]):
        path.write_bytes(cut)
        with pytest.raises(pneuservo.InputError, match="found a file that is damaged or no") as refused:
            export.read(path)
        assert len(refused.value.sentences) == 1
    path.write_bytes(whole)

    def fails(recording, partial):
        partial.write_bytes(b"half")
        raise OSError("disk full")

    monkeypatch.setitem(export._WRITERS, suffix, fails)
    with pytest.raises(OSError, match="disk full"):
        export.write(swept, path, replace=True)
    assert path.read_bytes() == whole and [one.name for one in tmp_path.iterdir()] == [path.name]
    with pytest.raises(pneuservo.InputError, match="found no file there"):
        export.read(tmp_path / f"nowhere{suffix}")


@pytest.mark.parametrize("suffix, package", [(".mat", "scipy"), (".parquet", "pyarrow"), (".mcap", "mcap")])
def test_a_byte_that_was_flipped_is_never_read_without_a_word(tmp_path, suffix, package):
    pytest.importorskip(package)
    from pneuservo import export

    seed = int(os.environ.get("PNEUSERVO_TEST_SEED", numpy.random.SeedSequence().entropy % 2**31))
    print(f"seed {seed} (PNEUSERVO_TEST_SEED)")
    draw = numpy.random.default_rng(seed)
    columns = {"t_s": numpy.arange(400) * 1e-3, "x_m": draw.normal(size=400), "u_V": draw.normal(size=400)}
    path, told = tmp_path / f"run{suffix}", 0
    export.write(pneuservo.Recording(columns, period_s=1e-3), path)
    whole = path.read_bytes()
    for place in draw.integers(len(whole), size=30):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1 << int(draw.integers(8))]) + whole[place + 1:])
        with warnings.catch_warnings(record=True) as words:
            warnings.simplefilter("always")
            try:
                again = export.read(path)
            except pneuservo.InputError:
                told += 1
                continue
        equal = all(name in again.keys() and same(again[name], values) for name, values in columns.items())
        assert equal or any("that were written" in str(one.message) for one in words), place
        told += not equal
    assert told > 5


def test_a_table_of_another_program_needs_numbers_and_takes_the_config_s_period(config, tmp_path):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    frame = pandas.DataFrame({"t_s": [0.0, 1e-3], "u_V": [1, 2]})
    frame.to_parquet(tmp_path / "other.parquet")
    run, = pneuservo.read_recordings(tmp_path / "other.parquet", config)
    assert run["u_V"].tolist() == [1.0, 2.0] and run.period_s == config.period_s and run.header == {}
    assert len(pneuservo.simulate(config, tmp_path / "other.parquet")["x_m"]) == 2
    frame.assign(words="a").to_parquet(tmp_path / "other.parquet")
    with pytest.raises(pneuservo.InputError, match="words: found a column of .*, expected numbers"):
        pneuservo.read_recordings(tmp_path / "other.parquet")


def test_the_command_leads_back_to_the_program_s_own_format(config, swept, tmp_path, capsys):
    pytest.importorskip("mcap")
    from pneuservo import export

    swept.write(str(tmp_path / "run.csv.gz"), config)
    own, = pneuservo.read_recordings(tmp_path / "run.csv.gz")
    (tmp_path / "back").mkdir()
    assert export.main([str(tmp_path / "run.csv.gz"), "--mcap", "--out", str(tmp_path)]) == 0
    assert export.main([str(tmp_path / "run.mcap"), "--csv", "--out", str(tmp_path / "back")]) == 0
    again, = pneuservo.read_recordings(tmp_path / "back/run.csv.gz", config)
    assert again.header_text == own.header_text and list(again.keys()) == list(own.keys()) and not again.problems
    assert all(same(again[name], own[name]) for name in own.keys())
    assert export.main([str(tmp_path / "run.mcap"), "--csv", "--out", str(tmp_path / "nofolder")]) == 2
    assert "nofolder: found no folder there, expected one: make it first" in capsys.readouterr().err
    odd = pneuservo.Recording({"t_s": numpy.arange(2.0), "a,b": numpy.arange(2.0)})
    with pytest.raises(pneuservo.InputError, match="found the column name 'a,b'"):
        export.write(odd, tmp_path / "odd.csv.gz")
    odd = pneuservo.Recording({"t_s": numpy.arange(2.0), "T [C]": numpy.array([numpy.nan, 1 / 3])}, rig="a: b")
    export.write(odd, tmp_path / "odd.csv.gz")
    back = export.read(tmp_path / "odd.csv.gz")
    assert back.rig == "a: b" and back.period_s == 1.0 and same(back["T [C]"], odd["T [C]"]) and not back.problems


def test_the_program_names_the_way_back(tmp_path):
    path = tmp_path / "run.dat"
    path.write_bytes(b"PAR1" + bytes(100))
    with pytest.raises(pneuservo.InputError, match="python -m pneuservo.export FILE --csv"):
        pneuservo.read_recordings(path)


@pytest.mark.parametrize("columns, words", [(5, "Recording: found int, expected a file, a Recording, or a mapping"),
                                            ({1: numpy.zeros(2)}, "Recording: found int as a column's name, expected text")])
def test_what_is_no_recording_is_named(columns, words):
    with pytest.raises(TypeError, match=words):
        pneuservo.Recording(columns)
