# Recordings: files, arrays, pandas, foreign loggers, and the formats of other programs, equal to the last bit.
import struct
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
        # By the index: from the middle on, and only that.
        half_ns = 50_000_000_000
        found = [numpy.frombuffer(message.data[4:])[1] for _, _, message in seeking.iter_messages(starting_at=half_ns)]
    assert numpy.array_equal(found, numpy.sin(t_s[50_000:]))
    assert mcap_file.read(tmp_path / "run.mcap")[0]["u_V"].tolist() == numpy.sin(t_s).tolist()


@pytest.mark.parametrize("indexes", ["ALL", "NONE"])
def test_an_mcap_of_another_program_gives_the_rows_of_its_topic(indexes, tmp_path):
    writer = pytest.importorskip("mcap.writer")
    from pneuservo import export

    rows = numpy.random.default_rng(3).normal(size=(400, 2))
    rows[:, 0] = numpy.arange(400) * 1e-3
    with open(tmp_path / "other.mcap", "wb") as file:
        out = writer.Writer(file, chunk_size=1 << 12, index_types=writer.IndexType[indexes])
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


def test_rows_that_are_left_out_are_warned_of():
    with pytest.warns(UserWarning, match="t_s"):
        recording = pneuservo.Recording({"t_s": numpy.array([0.0, 0.1, 0.05, 0.2]), "u_V": numpy.arange(4.0)})
    assert len(recording) == 3
