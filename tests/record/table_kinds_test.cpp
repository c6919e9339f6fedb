// Heads, ends and numbers of tables as loggers write them: read rightly, or refused in a sentence.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/files.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/import.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

constexpr int kind_rows = 60;
double kind_t_s(int i) { return i * 1e-3; }
double kind_x_mm(int i) { return -4.690 + 0.195 * i; }
double kind_u_V(int i) { return 0.0105 - 0.0005 * i; }
double kind_p_bar(int i) { return 5.002 + 0.001 * (i % 7); }

/// Rows whose line is written from the row's number.
std::string kind_lines(const std::function<std::string(int)>& line) {
  std::string out;
  for (int i = 0; i < kind_rows; ++i) out += line(i) + "\n";
  return out;
}

std::string plain_row(int i) {
  return fmt::format("{:.3f},{:.3f},{:.5f},{:.4f}", kind_t_s(i), kind_x_mm(i), kind_u_V(i), kind_p_bar(i));
}

const std::string kind_names = "Time [s],Position [mm],Valve [V],Pressure A [bar]\n";

CsvTable kind_table(const std::string& bytes) {
  const TemporaryFolder folder;
  return read_table(put_plain(folder.file("f.csv"), bytes));
}

std::string kind_refusal(const std::string& bytes) {
  try {
    kind_table(bytes);
  } catch (const InputError& error) { return error.what(); }
  return "";
}

std::string kind_sentences(const CsvTable& table) {
  std::string out;
  for (const RecordingProblem& problem : table.problems) out += problem.sentence + "\n";
  return out;
}

/// Time, position, command and pressure of every row are those that were written.
void check_kind(const std::string& bytes) {
  CAPTURE(bytes.substr(0, 200));
  const CsvTable table = kind_table(bytes);
  const std::vector<Recording> runs = recordings_in(table, import_map(guess_columns(table)), 0.001);
  REQUIRE(runs.size() == 1);
  REQUIRE(runs[0].rows() == kind_rows);
  REQUIRE(runs[0].has("p1_port_Pa"));
  for (int i = 0; i < kind_rows; ++i) {
    const auto row = static_cast<std::size_t>(i);
    REQUIRE(runs[0].t_s()[row] - runs[0].t_s()[0] == Approx(kind_t_s(i)).margin(1e-6));
    REQUIRE(runs[0].column("x_m")[row] == Approx(1e-3 * kind_x_mm(i)).margin(1e-9));
    REQUIRE(runs[0].column("u_V")[row] == Approx(kind_u_V(i)).margin(1e-9));
    REQUIRE(runs[0].column("p1_port_Pa")[row] == Approx(1e5 * kind_p_bar(i)).epsilon(1e-9));
  }
}

/// The rows with one field written otherwise.
std::string with_position(const std::function<std::string(int)>& position) {
  return kind_names + kind_lines([&](int i) {
           return fmt::format("{:.3f},{},{:.5f},{:.4f}", kind_t_s(i), position(i), kind_u_V(i), kind_p_bar(i));
         });
}

}  // namespace

TEST_CASE("names without fields in any row are refused where they may be any, and left out at the end") {
  const std::string rows = kind_lines(plain_row);
  CHECK_THAT(kind_refusal("Time [s],Date,Position [mm],Valve [V],Pressure A [bar]\n" + rows),
             Contains("line 1") && Contains("found 5 names") && Contains("at most 4 fields"));
  CHECK_THAT(kind_refusal("Nr," + kind_names + rows), Contains("found 5 names"));
  check_kind("Time [s],Position [mm],Valve [V],Pressure A [bar],Remark\n" + rows);
}

TEST_CASE("a second table with other names below the first is refused") {
  const std::string first = "Time [s],Position [mm],Valve [V]\n0.000,0.1,2\n0.001,0.1,2\n";
  for (const char* other : {"Time [s],Pressure A [bar],Pressure B [bar]\n0.000,5,6\n", "Time [s],Force [N]\n0.000,5\n",
                            "t,Pressure A,Pressure B\n0.000,5,6\n"})
    CHECK_THAT(kind_refusal(first + other), Contains("line 4") && Contains("found other column names"));
}

TEST_CASE("factors of columns are not passed over") {
  const std::string rows = kind_lines(plain_row);
  const std::string names = "Time,Position,Valve,Pressure A\ns,mm,V,bar\n";
  CHECK_THAT(kind_refusal(names + "1,0.01,1,0.1\n" + rows), Contains("line 3") && Contains("factors"));
  CHECK_THAT(
      kind_refusal("Channel," + names + "Scale,1,0.01,1,0.1\n" + kind_lines([](int i) { return "," + plain_row(i); })),
      Contains("factors"));
  std::string pairs =
      "Name\tPosition\tName\tValve\tName\tPressure A\nScaleFactor\t0.1\tScaleFactor\t1\tScaleFactor\t1\n"
      "Unit\tmm\tUnit\tV\tUnit\tbar\n\n";
  for (int i = 0; i < kind_rows; ++i)
    pairs += fmt::format("{0}\t{1:.3f}\t{0}\t{2:.5f}\t{0}\t{3:.4f}\n", i, kind_x_mm(i), kind_u_V(i), kind_p_bar(i));
  CHECK(kind_refusal(pairs).empty());
  std::string matrix = "t_s x_mm u_V p1_port_Pa\n   1.0e+05 *\n\n";
  for (int i = 0; i < kind_rows; ++i)
    matrix += fmt::format("   {:.8f}   {:.10f}   {:.12f}   {:.8f}\n", 1e-5 * kind_t_s(i), 1e-5 * kind_x_mm(i),
                          1e-5 * kind_u_V(i), kind_p_bar(i));
  check_kind(matrix);
}

TEST_CASE("numbers above and below the rows with other decimals in every column are told and are no rows") {
  const std::string rows = kind_lines(plain_row);
  for (const char* above : {"0;300;10;10", "0;1;2;3", ";-182.84;-1.475;3.8\n;111.7;1.2255;7.1"}) {
    std::string line = std::string(above) + "\n";
    std::replace(line.begin(), line.end(), ';', ',');
    check_kind(kind_names + line + rows);
    CHECK_THAT(kind_sentences(kind_table(kind_names + line + rows)),
               Contains("line 2: the numbers have other decimals"));
  }
  check_kind(kind_names + rows + "Operator,me\n1,2,3,4\n");
  check_kind(kind_names + rows + "0.0295,1.06,-0.0042,5.0\n");
}

TEST_CASE("attributes below the names are no names, and a label before every unit is taken off") {
  const std::string rows = kind_lines(plain_row);
  const std::string units = "Unit: s,Unit: mm,Unit: V,Unit: bar\n", names = "time,Position,Valve,Pressure A\n";
  check_kind(names + units + rows);
  check_kind(names + "Type: double,Type: double,Type: single,Type: double\n" + units + rows);
  check_kind(names + units + "Interp: linear,Interp: linear,Interp: zoh,Interp: linear\n" + rows);
  check_kind(kind_names + "TIME,REAL,LREAL,REAL\n" + rows);
}

TEST_CASE("signs, powers and digits of other shapes are numbers") {
  const auto below_zero = [](int i, std::string_view minus) {
    return (kind_x_mm(i) < 0 ? std::string(minus) : "") + fmt::format("{:.3f}", std::abs(kind_x_mm(i)));
  };
  for (const char* minus : {"\u2012", "\u2010", "- ", "\uff0d"})
    check_kind(with_position([&](int i) { return below_zero(i, minus); }));
  for (const char* power : {"-003", "*10^-3", "\u00d710\u207b\u00b3", " x 10^-3"})
    check_kind(with_position([&](int i) { return fmt::format("{:.2f}{}", 1e3 * kind_x_mm(i), power); }));
  check_kind(with_position([](int i) {
    std::string out;
    for (const char c : fmt::format("{:.3f}", kind_x_mm(i))) out += {'\xef', '\xbc', static_cast<char>(c + 0x60)};
    return out;
  }));
  check_kind("t_s,x_mm,u_V,pressure A [Pa]\n" + kind_lines([](int i) {
               return fmt::format("{:.3f},{:.3f},{:.5f},{:.4f}k", kind_t_s(i), kind_x_mm(i), kind_u_V(i),
                                  100 * kind_p_bar(i));
             }));
}

TEST_CASE("a mark behind a number is told and left out, one that makes it a bound is not") {
  const auto marked = [](const char* mark) {
    return with_position([&](int i) { return fmt::format("{:.3f}{}", kind_x_mm(i), i % 3 == 0 ? mark : ""); });
  };
  for (const char* mark : {"*", "(*)", " OK", "!"}) {
    check_kind(marked(mark));
    CHECK_THAT(kind_sentences(kind_table(marked(mark))), Contains("the mark behind it is left out"));
  }
  CHECK(std::isnan(kind_table(marked("<")).values[1][0]));
}

TEST_CASE("a sign before three digits stands for thousands where numbers below a thousand have none") {
  for (const char sign : {',', '.'}) {
    std::string text = "Time [ms];Position [um];Pressure A [kPa]\n", decimals = text;
    for (int i = 0; i < kind_rows; ++i) {
      const int x_um = -4690 + 195 * i;
      std::string x = std::to_string(x_um);
      if (std::abs(x_um) >= 1000) x.insert(x.size() - 3, 1, sign);
      text += fmt::format("{};{};500\n", i, x);
      decimals += fmt::format("{};{}{}{:03};500\n", i, x_um / 1000, sign, std::abs(x_um) % 1000);
    }
    const CsvTable table = kind_table(text), plain = kind_table(decimals);
    REQUIRE(table.rows() == kind_rows);
    for (std::size_t i = 0; i < kind_rows; ++i)
      REQUIRE(table.values[1][i] == Approx(-4690 + 195 * static_cast<double>(i)));
    CHECK_THAT(kind_sentences(table), Contains("is taken for thousands"));
    CHECK(plain.values[1][0] == Approx(-4.690));
  }
}

TEST_CASE("units behind the values may change from row to row and may begin below the first row") {
  check_kind("t,Position [mm],Valve,Pressure A\n" + kind_lines([](int i) {
               const std::string pressure = i % 2 == 0 ? fmt::format("{:.6f} MPa", 0.1 * kind_p_bar(i))
                                                       : fmt::format("{:.3f} kPa", 100 * kind_p_bar(i));
               return fmt::format("{}{},{:.3f},{:.2f} mV,{}", i == 0 ? 0 : i, i == 0 ? "s" : "ms", kind_x_mm(i),
                                  1e3 * kind_u_V(i), pressure);
             }));
  const CsvTable late = kind_table("t_s;x_m;Pressure A\n0.000;0.1;\n0.001;0.1;498.40 kPa\n0.002;0.1;499.50 kPa\n");
  CHECK(late.units[2] == "kPa");
  CHECK(late.values[2][2] == Approx(499.5));
}

TEST_CASE("a last row without a line end is used where nothing is missing in it") {
  const std::string rows = kind_lines(plain_row);
  const std::string whole = kind_names + rows.substr(0, rows.size() - 1);
  check_kind(whole);
  const CsvTable cut = kind_table(whole.substr(0, whole.size() - 1));
  CHECK(cut.rows() == kind_rows - 1);
  CHECK_THAT(kind_sentences(cut), Contains("cut off"));
}

TEST_CASE("names may stand between other separators than the fields, and unknown separators are told") {
  const std::string rows = kind_lines(plain_row);
  std::string names = kind_names, fields = rows;
  std::replace(names.begin(), names.end(), ',', ';');
  check_kind(names + rows);
  std::replace(fields.begin(), fields.end(), ',', '\t');
  check_kind(kind_names + fields);
  std::replace(fields.begin(), fields.end(), '\t', '&');
  CHECK_THAT(kind_refusal("t_s&x_mm&u_V&p1_port_Pa\n" + fields), Contains("found one field in each line"));
}

TEST_CASE("what is like another kind for some rows is read as what it is") {
  SECTION("integer times in steps of 100 are no hours, minutes and seconds") {
    for (const int step : {50, 100, 200, 1000}) {
      const CsvTable table = kind_table(
          "time,x_mm\n" + kind_lines([&](int i) { return fmt::format("{},{:.3f}", step * i, kind_x_mm(i)); }));
      CHECK(table.is_clock[0] == 0);
      CHECK(table.values[0][3] == 3 * step);
    }
  }
  SECTION("a counter of 14 digits is no date") {
    const CsvTable table = kind_table(
        "ticks,x_mm\n" + kind_lines([&](int i) { return fmt::format("{},{:.3f}", 20101231000030 + i, kind_x_mm(i)); }));
    CHECK(table.is_clock[0] == 0);
    CHECK(table.values[0][40] - table.values[0][0] == 40);
    const CsvTable named = kind_table("time_ns,x_mm\n" + kind_lines([&](int i) {
                                        return fmt::format("{},{:.3f}", 19990131100000 + 1000000LL * i, kind_x_mm(i));
                                      }));
    CHECK(named.is_clock[0] == 0);
    CHECK(named.values[0][0] == 19990131100000.0);
  }
  SECTION("a bare zero shows no thousands, and a file has one sign for them") {
    const CsvTable zero =
        kind_table("t_ms,p1_bar\n" + kind_lines([](int i) {
                     return i < 2 ? fmt::format("{},0", i) : fmt::format("{},{:.3f}", i, kind_p_bar(i));
                   }));
    CHECK(zero.values[1][5] == Approx(kind_p_bar(5)));
    const CsvTable thousands = kind_table("t_ms;pos_um\n" + kind_lines([](int i) {
                                            return i < 40 ? fmt::format("{};{}.{:03}", 25 * i, 150 + i, i)
                                                          : fmt::format("1.{:03};{}.{:03}", 25 * (i - 40), 150 + i, i);
                                          }));
    CHECK(thousands.values[0][41] == 1025);
    CHECK(thousands.values[1][3] == 153003);
  }
  SECTION("rows at the ends that go on are rows, whatever their decimals") {
    const auto row = [](int i) {
      return fmt::format("{:.3f},{:.3f},{:.3f},{:.3f}", 0.001 * i, kind_x_mm(i), kind_u_V(i), kind_p_bar(i));
    };
    const std::string names = "t_s,x_mm,u_V,p1_bar\n";
    CHECK(kind_table(names + kind_lines([&](int i) { return i == 0 ? "0,0,0,0" : row(i); })).rows() == kind_rows);
    CHECK(kind_table(names + kind_lines([&](int i) { return i == kind_rows - 1 ? "0.059,7,0,5" : row(i); })).rows() ==
          kind_rows);
  }
  SECTION("a gauge by name whose unit says absolute is absolute") {
    CsvTable table = kind_table("t_s,Pressure gauge A (bar abs)\n" + kind_lines([](int i) {
                                  return fmt::format("{:.3f},{:.3f}", 0.001 * i, kind_p_bar(i));
                                }));
    CHECK(guess_columns(table)[1].offset == 0);
  }
  SECTION("numbers in German rows are no channels of a long table") {
    const CsvTable table =
        kind_table("Zeit;p1 [bar];p2 [bar]\n" + kind_lines([](int i) {
                     return fmt::format("10:11:12,{:03};5,{}00;4,{}00", 10 * i, 3 + i % 2, 5 - i % 2);
                   }));
    REQUIRE(table.names.size() == 3);
    REQUIRE(table.rows() == kind_rows);
    CHECK(table.values[0][7] - table.values[0][0] == Approx(0.07));
  }
  SECTION("a whole time beside columns named like its parts is kept") {
    const CsvTable table = kind_table("t_ms,x_mm,h,mm,s\n" + kind_lines([](int i) {
                                        return fmt::format("{},{:.3f},1,2,{}", i, kind_x_mm(i), i % 7);
                                      }));
    CHECK(table.names.size() == 5);
  }
  SECTION("the frequency of a motion is no rate of the rows") {
    CHECK_THAT(kind_sentences(kind_table("# frequency: 10 Hz\nx_mm,u_V\n" + kind_lines([](int i) {
                                           return fmt::format("{:.3f},{:.4f}", kind_x_mm(i), kind_u_V(i));
                                         }))),
               !Contains("frequency"));
  }
  SECTION("units with a label of another language") {
    const CsvTable table = kind_table("Zeit;Weg\nEinheit: s;Einheit: mm\n" + kind_lines([](int i) {
                                        return fmt::format("{:.3f};{:.3f}", 0.001 * i, kind_x_mm(i));
                                      }));
    CHECK(guess_columns(table)[1].factor == Approx(1e-3));
  }
  SECTION("what is told of one column's text leaves another's") {
    const CsvTable table =
        kind_table("t_s,p,xp,x_mm\n" + kind_lines([](int i) {
                     return fmt::format("{:.3f},on,{},{:.3f}", 0.001 * i, i == 8 ? "bad" : "1.5", kind_x_mm(i));
                   }));
    CHECK_THAT(kind_sentences(table), Contains("xp is \"bad\"") && Contains("column p holds text"));
  }
  SECTION("a long field of signs ends") {
    std::string signs;
    for (int i = 0; i < 200000; ++i) signs += "\u5e74";
    CHECK(kind_table("t_s,x_mm\n" +
                     kind_lines([&](int i) { return fmt::format("{:.3f},{}", 0.001 * i, i == 9 ? signs : "1.5"); }))
              .rows() == kind_rows);
  }
}
