// Tables of measuring instruments, controllers and middleware that keep times, names and units in ways of their own.
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"
#include "record/motion.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

TEST_CASE("seconds and their fraction in two columns are one time") {
  const auto with = [](const char* seconds, const char* fraction, double per_s) {
    return check_motion(
        fmt::format("{},{},position,valve\n", seconds, fraction) + rows([&](int i, double, double x, double u) {
          return fmt::format("{},{:.0f},{:.7f},{:.4f}", 1770000000 + i / 1000, i % 1000 * 1e-3 * per_s, x, u);
        }));
  };
  CHECK_THAT(with("header.stamp.sec", "header.stamp.nanosec", 1e9), Contains("nanoseconds of header.stamp.sec"));
  CHECK_THAT(with("header.stamp.secs", "header.stamp.nsecs", 1e9), Contains("nanoseconds"));
  CHECK_THAT(with("tv_sec", "tv_usec", 1e6), Contains("microseconds of tv_sec"));
  check_motion("Date,Millitm,position,valve\n" + rows([](int i, double, double x, double u) {
                 return fmt::format("2026-01-03 10:11:{:02},{},{:.7f},{:.4f}", i / 1000, i % 1000, x, u);
               }));
}

TEST_CASE("rows without times are counted by the interval or the rate of the head") {
  const std::string table = "Position_mm,Valve_V\n" + rows([](int, double, double x, double u) {
                              return fmt::format("{:.4f},{:.4f}", 1e3 * x, u);
                            });
  for (const char* head : {"Sample rate: 1000 Hz", "Sampling frequency = 1 kHz", "Sample interval [ms],1",
                           "Delta_X,0.001", "SampleRate,1000,1000", "# Sample time: 1000 us", "dt = 1e-3"}) {
    CAPTURE(head);
    CHECK_THAT(check_motion(std::string(head) + "\n" + table),
               Contains("rows are counted") && Contains("0.001 s apart"));
  }
  check_motion(
      "X_Columns\tNo\nSamples\t3000\t3000\nDelta_X\t0.001\t0.001\nX_Value\tPosition [mm]\tValve [V]\tComment\n" +
      rows([](int, double, double x, double u) { return fmt::format("\t{:.4f}\t{:.4f}", 1e3 * x, u); }));
  // Times of the rows are believed before a head.
  check_motion("Sample rate: 50 Hz\nTime,Position_mm,Valve_V\n" + rows([](int, double t, double x, double u) {
                 return fmt::format("{:.3f},{:.4f},{:.4f}", t, 1e3 * x, u);
               }));
}

TEST_CASE("what a head says of each channel is no name, and an empty name is that of the line above") {
  const auto table = [](const char* form, char separator) {
    return rows([&](int, double t, double x, double u) {
      std::string row = fmt::format(fmt::runtime(form), t, 1e3 * x, u);
      std::replace(row.begin(), row.end(), '|', separator);
      return row;
    });
  };
  check_motion(
      "T0=\t03.01.2026\nZeit [s]\tWeg [mm]\tVentil [V]\nlength=3000\tlength=3000\tlength=3000\n"
      "sample rate = 1000,0 Hz\tsample rate = 1000,0 Hz\tsample rate = 1000,0 Hz\nSerno: 0\tSerno: 1\tSerno: 1\n" +
      with_comma(table("{:.3f}|{:.4f}|{:.4f}", '\t')));
  check_motion("LabVIEW Measurement\t\nX_Dimension\tTime\tTime\t\nX0\t0,0E+0\t0,0\t\nX_Value\tPosition [mm]\tValve "
               "[V]\tComment\n" +
               with_comma(table("{:.3f}|{:.4f}|{:.4f}", '\t')));
  check_motion("\"Time\",\"CH1-1\",\"CH1-2\"\n\"\",\"Position\",\"Valve\"\n\"[s]\",\"[mm]\",\"[V]\"\n" +
               table("{:.3f}|{:.4f}|{:.4f}", ','));
  check_motion("; logger 3\n;t_s;x_mm;u_V\n" + table("{:.3f}|{:.4f}|{:.4f}", ';'));
}

TEST_CASE("lines in quotes as a whole are the lines inside") {
  check_motion("\"Time,Position \"\"A\"\" [mm],Valve_V\"\n" + rows([](int, double t, double x, double u) {
                 return fmt::format("\"{:.3f},{:.4f},{:.4f}\"", t, 1e3 * x, u);
               }));
}

TEST_CASE("times that are named after their values make pairs") {
  for (const char* names : {"Position Time,Position Value [mm],Valve Time,Valve Value [V]",
                            "Weg Zeit (s),Weg Wert (mm),Ventil Zeit (s),Ventil Wert (V)"}) {
    CAPTURE(names);
    check_motion(std::string(names) + "\n" + rows([](int, double t, double x, double u) {
                   return fmt::format("{0:.3f},{1:.4f},{0:.3f},{2:.4f}", t, 1e3 * x, u);
                 }));
  }
}

TEST_CASE("one group of thousands is one where other numbers show the decimal sign") {
  const auto grouped = [](int value, char sign) {
    return value < 1000 ? std::to_string(value) : fmt::format("{}{}{:03}", value / 1000, sign, value % 1000);
  };
  CHECK_THAT(check_motion("Time (ms),Position (mm),Valve (V)\n" + rows([&](int i, double, double x, double u) {
                            return fmt::format("\"{}\",{:.4f},{:.4f}", grouped(i, ','), 1e3 * x, u);
                          })),
             Contains("a comma is taken for thousands"));
  check_motion("Zeit (ms);Weg (mm);Ventil (V)\n" + rows([&](int i, double, double x, double u) {
                 return grouped(i, '.') + ";" + with_comma(fmt::format("{:.4f};{:.4f}", 1e3 * x, u));
               }));
  // A column that shows its sign otherwise has decimals of its own.
  const Understood mixed =
      understood("Seconds;Weg (m);Ventil (V);p1 (bar)\n0.000;0,5;1,5;0.98\n0.001;0,6;1,6;4.125\n0.002;0,7;1,7;4.25\n");
  CHECK(mixed.run.t_s() == std::vector<double>{0, 0.001, 0.002});
  CHECK(mixed.run.column("p1_port_Pa")[1] == Approx(4.125e5));
  const Understood kilopascals =
      understood("Time;Weg (m);Ventil (V);Kraft (N);p1 "
                 "(kPa)\n0.000;0,5;1,5;7,5;349.198\n0.001;0,6;1,6;7,6;350.125\n0.002;0,7;1,7;7,5;351.5\n");
  CHECK(kilopascals.run.column("p1_port_Pa")[0] == Approx(349198));
  CHECK_THAT(mixed.told, Contains("is taken for the decimal sign"));
}

TEST_CASE("what instruments write for no value and for overflow is no value") {
  for (const char* mark : {"9.91E+37", "-9.9E37", "1.7E+308"}) {
    CAPTURE(mark);
    const Understood found = understood(fmt::format("t_s,x_m\n0,0.1\n0.001,{}\n0.002,0.12\n0.003,0.13\n", mark));
    CHECK(std::isnan(found.run.column("x_m")[1]));
    CHECK_THAT(found.told, Contains("x_m is " + std::string(mark)));
  }
}

TEST_CASE("units in braces, before the name, behind a sign or a capital letter") {
  for (const char* names :
       {"Time {ms},Position {mm},Valve {V}", "[ms] Time,[mm] Position,[V] Valve", "time.ms,position.mm,valve.V",
        "timeMs,positionMm,valveV", "Time: ms,Position: mm,Valve: V", "時刻［ms］,変位［mm］,指令電圧［V］",
        "时间(ms),位移(mm),控制电压(V)", "S,Time_ms,Position_mm,Valve_V"}) {
    const std::string before = std::string(names).starts_with("S,") ? "0," : "";
    check_motion(std::string(names) + "\n" + rows([&](int i, double, double x, double u) {
                   return fmt::format("{}{},{:.4f},{:.4f}", before, i, 1e3 * x, u);
                 }));
  }
  // A name of the recording format is in SI: no other column with a unit takes its place.
  CHECK(understood("t_s,x_m,Position [mm]\n0,0.1,7\n0.001,0.1,8\n0.002,0.2,9\n").run.column("x_m")[2] == 0.2);
  const TemporaryFolder folder;
  const CsvTable table =
      read_table(put_plain(folder.file("f.csv"), "t_s,posIn,Main.s,posMin\n0,1,2,3\n1,1,2,3\n2,1,2,3\n"));
  for (const ColumnGuess& guess : guess_columns(table)) CHECK(guess.factor == 1);
}

TEST_CASE("Japanese and Chinese names") {
  const auto ours = [](const char* name) {
    const auto word = column_word(name);
    return word ? std::string(word->ours) : "none";
  };
  CHECK(ours("圧力A") == "p1_port_Pa");
  CHECK(ours("ポートB圧力") == "p2_port_Pa");
  CHECK(ours("供給圧力") == "p_supply_Pa");
  CHECK(ours("ロッド側圧力") == "p2_port_Pa");
  CHECK(ours("无杆腔压力") == "p1_chamber_Pa");
  CHECK(ours("有杆腔压力") == "p2_chamber_Pa");
  CHECK(ours("气源压力") == "p_supply_Pa");
  CHECK(ours("目標位置") == "x_ref_m");
  CHECK(ours("实际位置") == "x_m");
  for (const char* name : {"位置偏差", "速度", "温度", "位置ずれ"}) {
    CAPTURE(name);
    CHECK((ours(name) == "none" || ours(name).empty()));
  }
}

TEST_CASE("a number in a head makes no thousands of decimals, and decimals that come late undo them") {
  const auto table = [](const std::string& bytes) {
    const TemporaryFolder folder;
    return read_table(put_plain(folder.file("f.csv"), bytes));
  };
  const CsvTable comma = table("Logger;3.2\nZeit_ms;p1_bar;p2_bar\n0;5,012;6,001\n1;5,013;6,002\n2;5,014;6,003\n");
  REQUIRE(comma.values.size() == 3);
  CHECK(comma.values[1][0] == 5.012);
  CHECK(comma.values[2][2] == 6.003);
  // The same column is thousands as long as nothing speaks against it.
  const std::string head = "t_ms;x_mm;p1_kPa\n0;0.25;1,250\n1;0.50;";
  CHECK(table(head + "1,260\n2;0.75;1,270\n").values[2][0] == 1250);
  const CsvTable late = table(head + "0,98\n2;0.75;1,270\n");
  CHECK(late.values[2][0] == 1.25);
  CHECK(late.values[2][1] == 0.98);
  CHECK(late.values[2][2] == 1.27);
}

TEST_CASE("whole numbers beside a time are no fractions of anything else") {
  const auto column = [](const std::string& head, const char* name, const std::function<std::string(int)>& row) {
    std::string bytes = head + "\n";
    for (int i = 0; i < 50; ++i) bytes += row(i) + "\n";
    const TemporaryFolder folder;
    const CsvTable table = read_table(put_plain(folder.file("f.csv"), bytes));
    for (std::size_t c = 0; c < table.names.size(); ++c)
      if (table.names[c] == name) return table.values[c];
    FAIL("no column " << name);
    return std::vector<double>{};
  };
  for (const double x : column("t_ms,s,u_V", "s", [](int i) { return fmt::format("{},0,1.5", i); })) CHECK(x == 0);
  for (const char* other : {"cycle_ms", "latency_us", "delay_ms"}) {
    CAPTURE(other);
    const auto times = column(fmt::format("time_s,{},x_mm", other), "time_s",
                              [](int i) { return fmt::format("{},{},{}", i, i % 3, 0.1 * i); });
    CHECK(times[7] == 7);
  }
  const auto beside_gaps = column("time_s,ms,x_mm", "time_s", [](int i) {
    return fmt::format("{},{},{}", i / 10, i == 7 ? "" : std::to_string(100 * (i % 10)), 0.1 * i);
  });
  CHECK(std::isfinite(beside_gaps[7]));
}

TEST_CASE("a rate in a unit that is not known, and one beside true times, counts nothing") {
  const auto names = [](const std::string& bytes) {
    const TemporaryFolder folder;
    return read_table(put_plain(folder.file("f.csv"), bytes)).names;
  };
  const std::string values = "x_mm,u_V\n0.1,1.5\n0.2,1.6\n0.3,1.7\n";
  CHECK(names("Sample Rate: 1000 Hz\n" + values).size() == 3);
  CHECK(names("Sample Rate: 10 kSa/s\n" + values).size() == 3);
  CHECK(names("Sample rate: 60/min\n" + values).size() == 2);
  CHECK(names("Increment: 0.005 mm\n" + values).size() == 2);
  CHECK(names("Abtastintervall: 1 ms\nZeit/s;x/mm\n0,001;1,5\n0,002;1,6\n0,004;1,7\n").size() == 2);
}

TEST_CASE("an ordinal is no time, and a name may hold a number") {
  const auto word = column_word("Secondary Supply Pressure");
  REQUIRE(word);
  CHECK(word->ours == "p_supply_Pa");
  REQUIRE(column_word("Second Position"));
  CHECK(column_word("Second Position")->ours == "x_m");
  const TemporaryFolder folder;
  const CsvTable table = read_table(
      put_plain(folder.file("f.csv"), "Logger A;Anlage B;Halle;Meier\nt;x;p1;24V\n0;1;2;3\n1;2;3;4\n2;3;4;5\n"));
  CHECK(table.names[1] == "x");
}

TEST_CASE("names may stand in two rows, an upper one for several columns") {
  const std::string table = rows([](int, double t, double x, double u) {
    return fmt::format("{:.3f},{:.1f},{:.1f},{:.4f},{:.4f}", t, 5.0, 6.0, 1e3 * x, u);
  });
  for (const char* names : {"Time,Pressure,,Position,Valve\n,A,B,cylinder,command\ns,bar,bar,mm,V\n",
                            "Time [s],Pressure [bar],,Position [mm],Valve [V]\n,A,B,,\n",
                            "Time [s],Pressure [bar],Pressure [bar],Position [mm],Valve [V]\n-,A,B,cylinder,main\n",
                            ",Pressure,,Position,\nTime [s],A [bar],B [bar],act [mm],Valve [V]\n"}) {
    CAPTURE(names);
    const Understood found = understood(names + table);
    CHECK_THAT(check_motion(names + table), Contains("names over two rows"));
    CHECK(found.run.column("p1_port_Pa")[7] == Approx(5e5));
    CHECK(found.run.column("p2_port_Pa")[7] == Approx(6e5));
  }
  // What is known by the lower row alone keeps its name.
  const Understood found =
      understood("Bench 3,Motion,Valve 7\nTime,Position,Valve\n" +
                 rows([](int, double t, double x, double u) { return fmt::format("{:.3f},{:.7f},{:.4f}", t, x, u); }));
  CHECK(found.columns[1].column == "Position");
  CHECK_THAT(found.told, !Contains("over two rows"));
}

TEST_CASE("a column of hexadecimal numbers holds counts") {
  const std::string told = check_motion("t_s,x_m,u_V,raw\n" + rows([](int i, double t, double x, double u) {
                                          return fmt::format("{:.3f},{:.7f},{:.4f},0x{:04X}", t, x, u, i);
                                        }));
  CHECK_THAT(told, Contains("raw holds hexadecimal numbers such as 0x0000"));
  const Understood counts = understood("t_s,x_m,raw\n" + rows([](int i, double t, double x, double) {
                                         return fmt::format("{:.3f},{:.7f},16#{:x}", t, x, i);
                                       }));
  CHECK(counts.run.rows() == row_count);
  // Between other numbers they are text.
  const TemporaryFolder folder;
  const CsvTable mixed = read_table(put_plain(folder.file("f.csv"), "t_s,x\n0,0x10\n1,16\n2,0x12\n3,18.5\n"));
  CHECK(std::isnan(mixed.column("x")[0]));
  CHECK(mixed.column("x")[1] == 16);
  const CsvTable all = read_table(put_plain(folder.file("g.csv"), "t_s,x\n0,0x1F4\n1,0\n2,0xFFFF\n"));
  CHECK(all.column("x")[0] == 500);
  CHECK(all.column("x")[2] == 65535);
}

TEST_CASE("a refused row leaves its place in the time where rows count it") {
  std::string text = "Sample rate: 1000 Hz\nPosition_mm,Valve_V\n";
  for (int i = 0; i < row_count; ++i)
    text += i == 1000 ? "0.5,1,7\n" : fmt::format("{:.4f},{:.4f}\n", 1e3 * x_m_at(i), u_V_at(i));
  const Understood found = understood(text);
  REQUIRE(found.run.rows() == row_count - 1);
  CHECK(found.run.missing_rows == 1);
  CHECK(found.run.t_s()[1500] == Approx(1.501));
  CHECK(found.run.column("x_m")[1500] == Approx(x_m_at(1501)));
  // A remark took no sample's place.
  std::string remarked = "Sample rate: 1000 Hz\nPosition_mm,Valve_V\n";
  for (int i = 0; i < row_count; ++i)
    remarked += fmt::format("{}{:.4f},{:.4f}\n", i == 1000 ? "valve replaced\n" : "", 1e3 * x_m_at(i), u_V_at(i));
  CHECK(understood(remarked).run.t_s()[1500] == Approx(1.5));
  // An index that skips numbers tells of rows that are missing.
  std::string counted = "Sample rate: 1000 Hz\n,Position_mm,Valve_V\n";
  for (int i = 0; i < row_count; ++i)
    if (i < 1000 || i >= 1010) counted += fmt::format("{},{:.4f},{:.4f}\n", i, 1e3 * x_m_at(i), u_V_at(i));
  const Recording run = understood(counted).run;
  CHECK(run.missing_rows == 10);
  CHECK(run.column("x_m")[1500] == Approx(x_m_at(1510)));
  CHECK(run.t_s()[1500] == Approx(1.51));
}

TEST_CASE("a file whose values exceed the memory is refused at the line where they do") {
  const TemporaryFolder folder;
  const std::string text = "t_s,x_m,u_V\n" + rows([](int, double t, double x, double u) {
                             return fmt::format("{:.3f},{:.7f},{:.4f}", t, x, u);
                           });
  std::string longer = text;
  for (int i = 0; i < 3; ++i) longer += text.substr(text.find('\n') + 1);
  const std::string path = put_plain(folder.file("f.csv"), longer);
  constexpr std::size_t most_bytes = 100000;
  CHECK_THROWS_WITH(read_table(path, {}, most_bytes),
                    Contains("line 4098: found 0 MB of rows up to here") && Contains("a quarter of the memory"));
  CHECK(read_table(path).rows() == 4 * row_count);
}

TEST_CASE("values bear their names in lines of a log, of JSON and of a database's line protocol") {
  check_motion("2026-01-03 10:11:00,000 INFO start\n" + rows([](int i, double, double x, double u) {
                 return fmt::format("2026-01-03 10:11:{:02},{:03} INFO [axis 1] position={:.7f} valve={:.4f}", i / 1000,
                                    i % 1000, x, u);
               }));
  check_motion(rows([](int, double t, double x, double u) {
    return fmt::format("{{\"t\": {:.3f}, \"position\": {:.7f}, \"valve\": {:.4f}}}", t, x, u);
  }));
  check_motion(rows([](int i, double, double x, double u) {
    return fmt::format(
        "{{\"timestamp\":\"2026-01-03T10:11:{:02}.{:03}Z\",\"axis\":\"A\",\"position\":{:.7f},\"valve\":{:.4f}}}",
        i / 1000, i % 1000, x, u);
  }));
  check_motion(rows([](int i, double, double x, double u) {
    return fmt::format("axis,host=plc1 position={:.7f},valve={:.4f},count={}i {}", x, u, i,
                       1767434671000000000 + i * 1000000L);
  }));
}

TEST_CASE("remarks with names and numbers behind the values of a table are text") {
  check_motion("time;position;valve;remark\n" + rows([](int i, double t, double x, double u) {
                 return fmt::format("{:.3f};{:.7f};{:.4f};mode={} error={}", t, x, u, i % 3, i % 5);
               }));
}

TEST_CASE("remarks behind the last value are left aside") {
  check_motion("time;position;valve\n" + rows([](int i, double t, double x, double u) {
                 return fmt::format("{:.3f};{:.7f};{:.4f}{}", t, x, u, i % 2 == 0 ? " # held" : " // moves");
               }));
}

TEST_CASE("a column in a unit of time that goes on is the time where none is named so") {
  const auto told = [](const char* names) {
    return understood(names + rows([](int, double t, double x, double u) {
                        return fmt::format("{:.3f},{:.7f},{:.4f}", t - 0.5, x, u);
                      }));
  };
  for (const char* names : {"x-axis,position,valve\nsecond,m,Volt\n", "Abscissa (s),position (m),valve (V)\n"}) {
    CAPTURE(names);
    const Understood found = told(names);
    REQUIRE(found.run.rows() == row_count);
    CHECK(found.run.column("x_m")[100] == Approx(x_m_at(100)));
    CHECK(found.run.t_s()[100] == Approx(-0.4));
  }
  check_motion("tick_us;position;valve\n" + rows([](int i, double, double x, double u) {
                 return fmt::format("0x{:08X};{:.7f};{:.4f}", 1000 * i, x, u);
               }));
}
