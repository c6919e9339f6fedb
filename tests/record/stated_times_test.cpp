// Times that a head states, that stand in several columns or only in some rows, or whose digits change.
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/foreign/clock_text.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/stamps.hpp"
#include "record/motion.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

/// The table without times.
std::string timeless_rows() {
  return "Position_mm,Valve_V\n" +
         rows([](int, double, double x, double u) { return fmt::format("{:.4f},{:.4f}", 1e3 * x, u); });
}

/// Rows whose time is the text.
std::string timed_rows(const std::string& name, const std::function<std::string(int)>& time) {
  return name + ";position;valve\n" +
         rows([&](int i, double, double x, double u) { return fmt::format("{};{:.7f};{:.4f}", time(i), x, u); });
}

}  // namespace

TEST_CASE("stamps with a fixed count of digits are spread by the resolution of each stretch") {
  for (const double start_s : {999.2, 99999.2}) {
    std::vector<double> stamps, even;
    for (int i = 0; i < 1500; ++i) {
      even.push_back(start_s + 0.001 * i);
      const double digit_s = even.back() < std::ceil(start_s) ? 0.001 : 0.01;
      stamps.push_back(std::round(even.back() / digit_s) * digit_s);
    }
    REQUIRE(spread_rounded(stamps));
    for (std::size_t i = 0; i < even.size(); ++i) CHECK(stamps[i] == Approx(even[i]).margin(5e-4));
    CHECK(interval_of(stamps) == Approx(0.001).epsilon(1e-3));
  }
}

TEST_CASE("rows between the stamps of blocks lie evenly between them") {
  CHECK_THAT(
      check_motion(timed_rows("Time", [](int i) { return i % 10 == 0 ? fmt::format("{:.2f}", 0.001 * i) : ""; })),
      Contains("2700 of 3000 rows have no time of their own"));
  check_motion(timed_rows("Time", [](int i) { return i % 20 == 0 ? fmt::format("10:11:{:06.3f}", 0.001 * i) : ""; }));
}

TEST_CASE("rows without a time that none follows for are counted") {
  const Understood found = understood(timed_rows("Time", [](int i) {
    return i >= 100 && i < 110 ? "" : fmt::format("{:.3f}", i < 100 ? 0.001 * i : 0.001 * i + 5);
  }));
  CHECK(found.run.rows() == row_count - 10);
  CHECK_THAT(found.told, Contains("10 of 3000 rows have no time"));
}

TEST_CASE("a rate or an interval in the head has many names") {
  for (const char* head : {"Rate: 1000 Hz",
                           "Frequency: 1 kHz",
                           "Scan rate [Hz];1000",
                           "Samples per second: 1000",
                           "Samples/sec: 1000",
                           "Period: 1 ms",
                           "Scan Interval: 1 ms",
                           "Cycle time: 1 ms",
                           "Timebase: 1 ms",
                           "Zykluszeit: 1 ms",
                           "Messfrequenz: 1 kHz",
                           "Abtastperiode: 1 ms",
                           "Acquisition Rate (S/s): 1000",
                           "sample_rate_hz: 1000",
                           "dt_ms: 1",
                           "Delta: 0.001 sec.",
                           "Fréquence d'échantillonnage : 1000 Hz",
                           "Frecuencia de muestreo: 1000 Hz",
                           "Frequenza di campionamento: 1000 Hz",
                           "サンプリング周期: 1 ms",
                           "サンプリング周波数,1000,Hz",
                           "采样频率：1000Hz",
                           "Sample interval: 0,001 s",
                           "Sample rate: 1,000 Hz",
                           "Rate: 5 Hz\nSample rate: 1000 Hz",
                           "Filter frequency: 200 Hz\nRate: 1000 Hz",
                           "Sample Rate: 2000 Hz\nDecimation: 2"}) {
    CAPTURE(head);
    CHECK_THAT(check_motion(std::string(head) + "\n" + timeless_rows()),
               Contains("rows are counted") && Contains("0.001 s apart"));
  }
}

TEST_CASE("a column without values or a name may state the interval") {
  const auto with = [](const std::string& names, const char* form) {
    return check_motion(names + rows([&](int i, double, double x, double u) {
                          return fmt::format(fmt::runtime(form), i, 1e3 * x, u);
                        }));
  };
  with("X,Position,Valve,Start,Increment,\nSequence,mm,V,0.000000e+00,1.000000e-03,\n", "{},{:.4f},{:.4f},,,");
  with("Time(s),Position(mm),Valve(V),t0 = 0, tInc = 0.001,\n", ",{1:.4f},{2:.4f},,");
  with("Sample (1 kHz),Position(mm),Valve(V)\n", "{},{:.4f},{:.4f}");
}

TEST_CASE("columns at rates or from starts of their own in the head are counted each by its own") {
  const auto head_and = [](const char* head) {
    std::string out = std::string(head) + "X_Value\tPosition [mm]\tValve [V]\tPressure A [bar]\tComment\n";
    for (int i = 0; i < 1000; ++i)
      out += fmt::format("\t{:.4f}\t{:.4f}\t{}\t\n", 1e3 * x_m_at(i), u_V_at(i),
                         i < 500 ? fmt::format("{:.4f}", 5 + 1e-3 * i) : "");
    return understood(out);
  };
  const Understood rates = head_and("Channels\t3\nDelta_X\t0.001\t0.001\t0.002\n***End_of_Header***\n");
  REQUIRE(rates.run.rows() == 1000);
  CHECK_THAT(rates.told, Contains("each column are counted at its own interval"));
  for (std::size_t i = 0; i < 1000; i += 2) {
    CHECK(rates.run.column("p1_port_Pa")[i] == Approx(5e5 + 50.0 * static_cast<double>(i)));
    CHECK(rates.run.column("x_m")[i] == Approx(x_m_at(static_cast<int>(i))).margin(1e-9));
  }
  const Understood starts =
      head_and("Channels\t3\nX0\t0\t0.05\t0\nDelta_X\t0.001\t0.001\t0.001\n***End_of_Header***\n");
  for (int i = 50; i < 1000; ++i)
    CHECK(starts.run.column("u_V")[static_cast<std::size_t>(i)] == Approx(u_V_at(i - 50)));
  CHECK_THROWS_WITH(head_and("Channels\t3\nDelta_X\t0.001\t0.002\n***End_of_Header***\n"),
                    Contains("2 intervals that differ") && Contains("one for each of the 3 columns"));
}

TEST_CASE("one order of day and month holds for a column, the one in which its times go on") {
  for (const auto& [before, behind] : {std::pair{"03/01/2026", "04/01/2026"},
                                       {"31/01/2026", "01/02/2026"},
                                       {"01.03.2026", "01.04.2026"},
                                       {"03-01-26", "04-01-26"},
                                       {"26/01/03", "26/01/04"},
                                       {"01/31/2026", "02/01/2026"},
                                       {"03.01.2026", "04.01.2026"}}) {
    CAPTURE(before, behind);
    check_motion(timed_rows("Time", [&, first = before, next = behind](int i) {
      return fmt::format("{} {:02}:{:02}:{:06.3f}", i < 1000 ? first : next, i < 1000 ? 23 : 0, i < 1000 ? 59 : 0,
                         i < 1000 ? 59 + 0.001 * i : 0.001 * (i - 1000));
    }));
  }
}

TEST_CASE("dates and times in digits alone") {
  CHECK(digits_clock_in("20260103101159.2").value() == Approx(clock_in("2026-01-03 10:11:59.2").value()));
  CHECK(digits_clock_in("20260103101159201").value() - digits_clock_in("20260103101159200").value() ==
        Approx(0.001).margin(1e-6));
  CHECK_FALSE(digits_clock_in("20261303101159"));
  CHECK_FALSE(digits_clock_in("1767434671000000"));
  CHECK_THAT(check_motion(timed_rows("Time",
                                     [](int i) {
                                       return i < 1000 ? fmt::format("1011{:06.3f}", 59 + 0.001 * i)
                                                       : fmt::format("1012{:06.3f}", 0.001 * (i - 1000));
                                     })),
             Contains("hhmmss"));
}

TEST_CASE("parts of a time in columns of their own are one time") {
  const auto with = [](const std::string& names, const std::function<std::string(int)>& time) {
    return check_motion(timed_rows(names, time));
  };
  const auto minute = [](int i) { return i < 1000 ? 11 : 12; };
  const auto second = [](int i) { return i < 1000 ? 59 : i < 2000 ? 0 : 1; };
  CHECK_THAT(with("Hour;Minute;Second;Millisecond",
                  [&](int i) { return fmt::format("10;{};{};{}", minute(i), second(i), i % 1000); }),
             Contains("Hour, Minute, Second, Millisecond"));
  with("Year;Month;Day;h;min;s",
       [&](int i) { return fmt::format("2026;1;3;10;{};{}.{:03}", minute(i), second(i), i % 1000); });
  with("Time;Sec", [&](int i) { return fmt::format("10:{};{}.{:03}", minute(i), second(i), i % 1000); });
  with("Time;Fraction [ms]", [](int i) { return fmt::format("10:11:{:02};{}.0", i / 1000, i % 1000); });
  with("Epoch;Fraction", [](int i) { return fmt::format("{};0.{:03}", 1767434671 + i / 1000, i % 1000); });
}

TEST_CASE("milliseconds behind other signs, zones and times as other countries write them") {
  const double at_s = clock_in("2026-01-03 10:11:59.2").value(), of_day_s = 10 * 3600 + 11 * 60 + 59.2;
  for (const char* text :
       {"10:11:59-200", "10:11:59+200", "10:11:59;200", "10:11:59 200", "10.11.59,200", "10h11:59.200"}) {
    CAPTURE(text);
    CHECK(clock_in(text).value() == Approx(of_day_s));
  }
  for (const char* text :
       {"20260103 10:11:59.200", "20260103_101159.200", "20260103-101159.200", "2026/01/03/10:11:59.200",
        "3.1.2026 10.11.59,200", "2026-01-03_10-11-59-200", "2026. 01. 03. 10:11:59.200",
        "2026-01-03 10:11:59.200 a.m.", "2026年1月3日 10時11分59.200秒", "2026年1月3日 10:11:59.200",
        "2026/1/3 上午10:11:59.200", "2026-01-03 10:11:59.200 Europe/Berlin", "2026-01-03 11:11:59.200 +0100 CET",
        "2026-01-03 11:11:59.200 UTC+1", "2026-01-03 11:11:59.200 GMT+01:00"}) {
    CAPTURE(text);
    REQUIRE(clock_in(text).has_value());
    CHECK(clock_in(text).value() == Approx(at_s).epsilon(1e-12));
  }
  CHECK(clock_in("-00:00:00.500").value() == Approx(-0.5));
  CHECK_FALSE(clock_in("2026-01-03 10:11:59+20:00"));
}

TEST_CASE("a refusal for want of times names the column and a field") {
  CHECK_THROWS_WITH(check_motion(timed_rows("Time", [](int) { return "soon"; })),
                    Contains("in column Time") && Contains("soon"));
}

TEST_CASE("counters of 24 bits and those with a sign go on behind their end") {
  CHECK_THAT(
      check_motion(timed_rows("t_us", [](int i) { return fmt::format("{}", (16077216 + 1000 * i) % (1 << 24)); })),
      Contains("24 bits"));
  CHECK_THAT(check_motion(timed_rows(
                 "t_ms", [](int i) { return fmt::format("{}", 32000 + i > 32767 ? i - 33536 : 32000 + i); })),
             Contains("16 bits"));
}

TEST_CASE("times within a second, a minute or an hour go on behind it") {
  const auto with = [](const std::string& name, const std::function<std::string(int)>& time) {
    return check_motion(name + ",x_m,u_V\n" + rows([&](int i, double, double x, double u) {
                          return fmt::format("{},{:.7f},{:.4f}", time(i), x, u);
                        }));
  };
  const auto second = [](int i) { return std::fmod(57.5 + 1e-3 * i, 60); };
  for (const char* name : {"ms", "time_ms", "Milliseconds", "Millisekunden", "Zeit [ms]"}) {
    CAPTURE(name);
    const std::string told = with(name, [](int i) { return fmt::format("{}", (i + 250) % 1000); });
    CHECK_THAT(told, Contains("t_s begins again where the second ends, 3 times"));
  }
  with("ms", [](int i) { return fmt::format("{}", i % 1000); });
  with("time", [](int i) { return fmt::format("{}", (i + 250) % 1000); });
  with("time_us", [](int i) { return fmt::format("{}", 1000 * (i + 250) % 1000000); });
  with("us", [](int i) { return fmt::format("{}", 1000 * (i + 250) % 1000000); });
  with("t_s", [](int i) { return fmt::format("{:.3f}", 1e-3 * ((i + 250) % 1000)); });
  for (const char* name : {"second", "Second", "Sekunde", "Seconds", "sec", "Time (s)", "t_s", "Segundos"}) {
    CAPTURE(name);
    const std::string told = with(name, [&](int i) { return fmt::format("{:.3f}", second(i)); });
    CHECK_THAT(told, Contains("t_s begins again where the minute ends, once"));
  }
  with("sec,ms", [](int i) { return fmt::format("{},{}", (57 + i / 1000) % 60, i % 1000); });
  with("minute,second", [&](int i) { return fmt::format("{},{:.3f}", i < 2500 ? 59 : 0, second(i)); });
  with("Time [min]", [&](int i) { return fmt::format("{:.9f}", std::fmod(59.99 + 1e-3 * i / 60, 60)); });
  with("time", [&](int i) { return fmt::format("{}:{:06.3f}", i < 2500 ? "59" : "00", second(i)); });
}

TEST_CASE("runs of exactly a second each stay runs, and a second valve is no time") {
  const TemporaryFolder folder;
  const std::string bytes =
      "t_s,x_m,u_V\n" + rows([](int i, double, double, double) {
        return fmt::format("{:.3f},{:.7f},{:.4f}", 1e-3 * (i % 1000), x_m_at(i % 1000), u_V_at(i % 1000));
      });
  const CsvTable table = read_table(put_plain(folder.file("f.csv"), bytes));
  CHECK(recordings_in(table, import_map(guess_columns(table)), 0.001).size() == 3);
  // Each begins and ends at the same place.
  for (const char* name : {"t_s", "Time [s]", "time"}) {
    CAPTURE(name);
    const CsvTable home = read_table(
        put_plain(folder.file("home.csv"), std::string(name) + ",x_m,u_V\n" + rows([](int i, double, double, double) {
                                             const double way = std::sin(std::numbers::pi * 1e-3 * (i % 1000));
                                             return fmt::format("{:.3f},{:.7f},0", 1e-3 * (i % 1000), 0.05 * way * way);
                                           })));
    CHECK(recordings_in(home, import_map(guess_columns(home)), 0.001).size() == 3);
  }
  for (const char* name : {"Second Valve", "second pressure"}) {
    const std::optional<ColumnWord> word = column_word(name);
    CHECK((!word || word->ours != "t_s"));
  }
}
