// Tables of loggers, controllers and spreadsheets, each with the habit of its kind: read alike, or refused in one
// sentence.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "record/files.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"
#include "record/foreign/stamps.hpp"
#include "record/foreign/units.hpp"
#include "record/import.hpp"
#include "record/motion.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

constexpr int logged_rows = 400;
constexpr double logged_interval_s = 0.002;

/// Times, positions [m] and commands [V] of one drawn motion.
struct Logged {
  std::vector<double> t_s, x_m, u_V;
  Logged() {
    const unsigned seed = test::new_seed();
    UNSCOPED_INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> value(-1, 1);
    const double phase = value(generator);
    for (int i = 0; i < logged_rows; ++i) {
      t_s.push_back(i * logged_interval_s);
      x_m.push_back(std::round(1e5 * (0.1 * std::sin(7 * i * logged_interval_s + phase) + 0.001 * value(generator))) *
                    1e-5);
      u_V.push_back(std::round(1e3 * (2 * value(generator))) * 1e-3);
    }
  }
  std::string lines(const std::function<std::string(double, double, double)>& line) const {
    std::string out;
    for (std::size_t i = 0; i < t_s.size(); ++i) out += line(t_s[i], x_m[i], u_V[i]) + "\n";
    return out;
  }
};

/// Read by what its columns are taken for.
Recording read_runs(const std::string& bytes, std::size_t runs = 1) {
  const TemporaryFolder folder;
  const CsvTable table = read_table(put_plain(folder.file("f.csv"), bytes));
  const ImportParameters map = import_map(guess_columns(table));
  std::vector<Recording> found = recordings_in(table, map, 0.001);
  REQUIRE(found.size() == runs);
  return found.front();
}

void check_logged(const std::string& bytes, const Logged& drawn) {
  CAPTURE(bytes.substr(0, 200));
  const Recording run = read_runs(bytes);
  REQUIRE(run.rows() == drawn.t_s.size());
  REQUIRE(run.has("x_m"));
  REQUIRE(run.has("u_V"));
  CHECK(run.period_s == Approx(logged_interval_s).epsilon(2e-3));
  for (std::size_t i = 0; i < drawn.t_s.size(); ++i) {
    REQUIRE(run.t_s()[i] - run.t_s()[0] == Approx(drawn.t_s[i]).margin(1e-5));
    REQUIRE(run.column("x_m")[i] == Approx(drawn.x_m[i]).margin(1e-9));
    REQUIRE(run.column("u_V")[i] == Approx(drawn.u_V[i]).margin(1e-9));
  }
}

std::string refusal_of(const std::string& bytes) {
  try {
    read_runs(bytes);
  } catch (const InputError& error) { return error.what(); }
  return "";
}

}  // namespace

TEST_CASE("a last column without values, blanks that do not break and rows written twice do not matter") {
  const Logged drawn;
  const auto rows = [&](const char* form) {
    return drawn.lines([&](double t, double x, double u) { return fmt::format(fmt::runtime(form), t, 1e3 * x, u); });
  };
  check_logged("LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\n***End_of_Header***\t\n\t\nChannels\t2\n"
               "Samples\t400\t400\n***End_of_Header***\nX_Value\tPosition [mm]\tValve [V]\tComment\n" +
                   rows("{:.3f}\t{:.2f}\t{:.3f}"),
               drawn);
  for (const char* blank : {"\u00a0", "\u202f", "\xa0"}) {
    CAPTURE(blank);
    check_logged("t_s;x_mm;u_V\n" +
                     rows(("{:.3f};" + std::string(blank) + "{:.2f}" + blank + ";{:.3f}" + blank).c_str()),
                 drawn);
  }
  check_logged("t_s,x_mm,u_V\n" + rows("{0:.3f},{1:.2f},{2:.3f}\n{0:.3f},{1:.2f},{2:.3f}"), drawn);
}

TEST_CASE("what a sensor gives is no position and no pressure, a command may be a current") {
  for (const char* unit : {"mA", "counts"}) {
    CAPTURE(unit);
    const std::string names = fmt::format("t_s,Position [{0}],Valve [{0}],Pressure A [{0}]\n", unit);
    const TemporaryFolder folder;
    const CsvTable table = read_table(put_plain(folder.file("f.csv"), names + "0,1,2,3\n0.002,2,3,4\n"));
    const ImportParameters map = import_map(guess_columns(table));
    CHECK(map.columns.count("u_V") == (std::string(unit) == "mA" ? 1 : 0));
    CHECK(map.columns.count("x_m") + map.columns.count("p1_port_Pa") == 0);
  }
}

TEST_CASE("times of controllers and spreadsheets are the same times") {
  const Logged drawn;
  const auto with = [&](const std::string& name, const std::function<std::string(double)>& time) {
    check_logged(name + ";x_m;u_V\n" + drawn.lines([&](double t, double x, double u) {
      return fmt::format("{};{:.5f};{:.3f}", time(t), x, u);
    }),
                 drawn);
  };
  const auto parts = [](const char* form, double t) {
    const auto ms = static_cast<int>(std::lround(1e3 * t));
    return fmt::format(fmt::runtime(form), ms / 1000, ms % 1000);
  };
  for (const char* form : {"T#{}s{}ms", "LTIME#{}s_{}ms", "TOD#10:11:{:02}.{:03}", "DT#2026-01-03-10:11:{:02}.{:03}",
                           "2026-01-03-10:11:{:02}.{:03}", "PT{}.{:03}S", "0h 1m {}.{:03}s", "75:{:02}.{:03}"}) {
    CAPTURE(form);
    with("Time", [&](double t) { return parts(form, t); });
  }
  with("Time", [](double t) { return fmt::format("{:.0f}", 134120000000000000.0 + std::round(1e7 * t)); });
  with("Time", [](double t) { return fmt::format("{:.0f}", 639030000000000000.0 + std::round(1e5 * t) * 100); });
  with("Time", [](double t) { return fmt::format("{:.0f}", 820000000000000000.0 + std::round(1e6 * t) * 1000); });
  with("Time", [](double t) { return fmt::format("{:.6f}", 3.85e9 + t); });
  with("Time", [](double t) { return fmt::format("{:.10f}", 46025.25 + t / 86400); });
  with("Time [h]", [](double t) { return fmt::format("{:.12f}", t / 3600); });
  with("Time [d]", [](double t) { return fmt::format("{:.12f}", t / 86400); });
}

TEST_CASE("a unit of the times follows from the loop's period, from nanoseconds to days") {
  for (const auto& [factor, words] : std::vector<std::pair<double, std::string>>{
           {1e-3, "milliseconds"}, {1e-6, "microseconds"}, {1e-9, "nanoseconds"}, {86400, "days"}}) {
    std::vector<double> stamps;
    for (int i = 0; i < 50; ++i) stamps.push_back(i * 1e-3 / factor);
    CHECK(unit_of_times(stamps, 1e-3, false).words == words);
  }
}

TEST_CASE("exports of measuring systems are read with their heads, labels, types and units") {
  const Logged drawn;
  const auto rows = [&](const char* form) {
    return drawn.lines([&](double t, double x, double u) { return fmt::format(fmt::runtime(form), t, 1e3 * x, u); });
  };
  check_logged(
      "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t400\t400\t\n"
      "Y_Unit_Label\tmm\tV\t\nX0\t0.0E+0\t0.0E+0\t\nDelta_X\t0.002\t0.002\t\n***End_of_Header***\t\t\t\n"
      "X_Value\tPosition\tValve\tComment\n" +
          rows("{:.3f}\t{:.2f}\t{:.3f}\t"),
      drawn);
  check_logged("type,Export\npath,Platform,Model Root/x,Model "
               "Root/u\nname,time,Position,Command\nunit,s,mm,V\ntrace_values,,,\n" +
                   rows(",{:.3f},{:.2f},{:.3f}"),
               drawn);
  check_logged("record\tENGLISH\nsampleCount\t400\t\ntime\tPosition\tCommand\nf8\tf8\tf8\ns\tmm\tV\n" +
                   rows("{:.3f}\t{:.2f}\t{:.3f}"),
               drawn);
  check_logged("s,mm,V\nTime,Position,Valve\n" + rows("{:.3f},{:.2f},{:.3f}"), drawn);
  check_logged("| Time [s] | Position [mm] | Valve [V] |\n|-----|:---:|-----|\n" + rows("| {:.3f} | {:.2f} | {:.3f} |"),
               drawn);
  check_logged("Time [s]  Position [mm]  Valve [V]\n" + rows("{:.3f}   {:.2f}   {:.3f}"), drawn);
  check_logged("sep=;\n\u201cTime [s]\u201d;\u201cPosition [mm]\u201d;\u201cValve [V]\u201d\n" +
                   rows("{:.3f};{:.2f};{:.3f}"),
               drawn);
  check_logged(rows("t_s:{:.3f},Position_mm:{:.2f},u_V:{:.3f}"), drawn);
  check_logged(rows("t_s={:.3f} Position_mm={:.2f} u_V={:.3f}"), drawn);
  check_logged("Time,Position,Valve\n" + rows("{:.3f}s,{:.2f}mm,{:.3f}V"), drawn);
}

TEST_CASE("every channel may have times of its own, also at another rate") {
  std::string text = "Name;Position;Name;Command\nSampleTime[ms];2;SampleTime[ms];4\nUnit;mm;Unit;V\n";
  for (int i = 0; i < logged_rows; ++i) {
    const bool has_command = 2 * i < logged_rows;
    text += fmt::format("{};{};{};{}\n", 2 * i, 10 + i, has_command ? fmt::format("{}", 4 * i) : "",
                        has_command ? fmt::format("{:.3f}", 0.01 * i) : "");
  }
  const Recording run = read_runs(text);
  REQUIRE(run.rows() == logged_rows);
  CHECK(run.period_s == Approx(logged_interval_s));
  CHECK(run.column("x_m")[7] == Approx(0.017));
  CHECK(run.column("u_V")[8] == Approx(0.04));
  CHECK(std::isnan(run.column("u_V")[7]));
}

TEST_CASE("milliseconds in a column of their own and behind a comma belong to the time") {
  const Logged drawn;
  check_logged("Date;Time;Millisecond;x_m;u_V\n" + drawn.lines([](double t, double x, double u) {
    const auto ms = static_cast<int>(std::lround(1e3 * t));
    return fmt::format("03.01.2026;10:11:{:02};{};{:.5f};{:.3f}", 12 + ms / 1000, ms % 1000, x, u);
  }),
               drawn);
  check_logged("time,x_m,u_V\n" + drawn.lines([](double t, double x, double u) {
    return fmt::format("2026-01-03 10:11:12,{:03.0f},{:.5f},{:.3f}", 1e3 * t, x, u);
  }),
               drawn);
}

TEST_CASE("a serial monitor's stamp before fields that bear their names is a time of its own") {
  const Logged drawn;
  check_logged(drawn.lines([](double t, double x, double u) {
    const auto ms = static_cast<int>(std::lround(1e3 * t));
    return fmt::format("10:15:{:02}.{:03} -> pos_mm:{:.2f},u_V:{:.3f}", ms / 1000, ms % 1000, 1e3 * x, u);
  }),
               drawn);
}

TEST_CASE("what stands between the rows costs none of them") {
  const Logged drawn;
  const auto row = [](double t, double x, double u) { return fmt::format("{:.3f},{:.5f},{:.3f}", t, x, u); };
  const std::string names = "t_s,x_m,u_V\n", rows = drawn.lines(row);
  const auto between = [&](const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < drawn.t_s.size(); ++i)
      out += (i % 50 == 0 ? text : "") + row(drawn.t_s[i], drawn.x_m[i], drawn.u_V[i]) + "\n";
    return out;
  };
  check_logged(between(names), drawn);
  check_logged(names + between("# an event\n"), drawn);
  check_logged(names + rows + "\nMin,-0.1,-2\nMax,0.1,2\nSamples: 400\n", drawn);
  check_logged(names + rows + std::string(4096, '\0'), drawn);
  check_logged("t_s,x_m,u_V,note\n" + row(drawn.t_s[0], drawn.x_m[0], drawn.u_V[0]) + ",start\n" +
                   rows.substr(rows.find('\n') + 1),
               drawn);
  check_logged(names + "023,0.1\n" + rows, drawn);
  std::string head;
  for (int i = 0; i < 900; ++i) head += fmt::format("Setting {}: {}\n", i, i * i);
  check_logged(head + names + rows, drawn);
  std::string ends;
  for (std::size_t i = 0; i < drawn.t_s.size(); ++i)
    ends += row(drawn.t_s[i], drawn.x_m[i], drawn.u_V[i]) + (i % 3 == 0 ? "\n" : i % 3 == 1 ? "\r\n" : "\r");
  check_logged(names + ends, drawn);
}

TEST_CASE("a decimal sign that the first rows do not show is found behind them") {
  std::string text = "t_ms;x_m;u_V\n", quoted = "t_ms,x_m,u_V\n";
  for (int i = 0; i < 2 * logged_rows; ++i) {
    const std::string x = i < logged_rows ? "0" : with_comma(fmt::format("{:.4f}", 1e-4 * (i - logged_rows + 1)));
    text += fmt::format("{};{};0\n", 2 * i, x);
    quoted += fmt::format("{},{},0\n", 2 * i, i < logged_rows ? x : "\"" + x + "\"");
  }
  for (const std::string& bytes : {text, quoted}) {
    const Recording run = read_runs(bytes);
    REQUIRE(run.rows() == 2 * logged_rows);
    CHECK(run.column("x_m").back() == Approx(1e-4 * logged_rows));
  }
}

TEST_CASE("other names in the middle of a file end in a sentence, for the columns behind them may be others") {
  const std::string first = "t_s,x_m,u_V\n0,0.1,2\n0.001,0.1,2\n";
  for (const char* other : {"t_s,u_V,x_m\n0.002,2,0.1\n", "t_s,F_N,x_m,u_V\n0.002,5,0.1,2\n"}) {
    CHECK_THAT(refusal_of(first + other),
               Contains("line 4") && Contains("found other column names") && Contains("split"));
  }
}

TEST_CASE("rows that no line of names belongs to are refused with what stands in them") {
  CHECK_THAT(
      refusal_of("VARIABLES = \"t [s]\" \"x [mm]\"\nZONE T=\"run 1\"\n0.0 1.5 0.1\n0.001 1.6 0.1\n0.002 1.7 0.1\n"),
      Contains("no row that can be used") && Contains("under the names") && Contains("line "));
}

TEST_CASE("stamps that do not tell the rows apart are refused, not averaged") {
  const Logged drawn;
  const auto with = [&](const std::function<std::string(double)>& time) {
    return refusal_of("t_s,x_m,u_V\n" + drawn.lines([&](double t, double x, double u) {
      return fmt::format("{},{:.5f},{:.3f}", time(t), x, u);
    }));
  };
  CHECK_THAT(with([](double t) { return fmt::format("{:g}", 1.77e9 + t); }),
             Contains("400 rows have 1 different times"));
  CHECK_THAT(with([](double t) { return fmt::format("10:11:{:02.0f}", 12 + std::floor(t + 0.5)); }),
             Contains("different times, expected a time for each row"));
}

TEST_CASE("a set point, an error, a speed or a temperature is not taken for what it belongs to") {
  const auto ours = [](const char* name) {
    const std::optional<ColumnWord> word = column_word(name);
    return word ? std::string(word->ours) : "-";
  };
  for (const char* name : {"position error",
                           "Pos_Err",
                           "Pos_Vel",
                           "x_dot",
                           "velocity",
                           "Valve_Temp",
                           "Valve_Current",
                           "Valve_Act",
                           "valve feedback",
                           "spool position",
                           "pressure setpoint A",
                           "supply voltage",
                           "Regelabweichung",
                           "cycle time",
                           "p1_temp",
                           "actualVelocity",
                           "ForceError",
                           "chamber_force",
                           "Druckkraft",
                           "Reibkraft",
                           "Kolbengeschwindigkeit",
                           "s_dot",
                           "u_ist",
                           "Zylindertemperatur 1",
                           "Differenzdruck",
                           "Druck",
                           "Solldruck 1",
                           "p1_est",
                           "Endlage 1",
                           "Steuerdruck 1",
                           "x_offset_z",
                           "Versorgungsspannung",
                           "Ventilposition",
                           "Zykluszeit",
                           "Abtastzeit",
                           "R\u00fccklaufdruck 1",
                           "fl\u00e4che A",
                           "volume chamber 1",
                           "vitesse du piston",
                           "Presi\u00f3n diferencial A"}) {
    CAPTURE(name);
    CHECK((ours(name) == "" || ours(name) == "-" || (std::string(name) == "spool position" && ours(name) != "u_V")));
  }
  for (const auto& [name, column] :
       std::vector<std::pair<const char*, std::string>>{{"position setpoint", "x_ref_m"},
                                                        {"Target Position", "x_ref_m"},
                                                        {"Sollposition", "x_ref_m"},
                                                        {"Pos_Cmd", "x_ref_m"},
                                                        {"Actual Position", "x_m"},
                                                        {"cylinder position", "x_m"},
                                                        {"MAIN.fbAxis.lrActPos", "x_m"},
                                                        {"fActPos", "x_m"},
                                                        {"rValveOut", "u_V"},
                                                        {"fPressA", "p1_port_Pa"},
                                                        {"f_piston", "F_N"},
                                                        {"Istposition", "x_m"},
                                                        {"Posici\u00f3n", "x_m"},
                                                        {"Posizione", "x_m"},
                                                        {"Positie", "x_m"},
                                                        {"Presi\u00f3n A", "p1_port_Pa"},
                                                        {"PRESSIONE 2", "p2_port_Pa"},
                                                        {"Druk 1", "p1_port_Pa"},
                                                        {"Comando valvola", "u_V"},
                                                        {"Stuurspanning", "u_V"},
                                                        {"Tijd", "t_s"},
                                                        {"millis", "t_s"},
                                                        {"Scope/Position:1", "x_m"},
                                                        {"/axis/state/position", "x_m"},
                                                        {"x filtered", "x_m"},
                                                        {"Valve_Cmd", "u_V"},
                                                        {"Ventilspannung", "u_V"},
                                                        {"Druck A", "p1_port_Pa"},
                                                        {"Pressure B", "p2_port_Pa"},
                                                        {"Pression 1", "p1_port_Pa"},
                                                        {"p_A", "p1_port_Pa"},
                                                        {"Chamber B pressure", "p2_chamber_Pa"},
                                                        {"Supply pressure", "p_supply_Pa"},
                                                        {"X_Value", "t_s"},
                                                        {"Druck P1", "p1_port_Pa"},
                                                        {"Druck_P2", "p2_port_Pa"},
                                                        {"Drucksensor 1", "p1_port_Pa"},
                                                        {"druckB", "p2_port_Pa"},
                                                        {"Kammerdruck 1", "p1_chamber_Pa"},
                                                        {"KammerdruckB", "p2_chamber_Pa"},
                                                        {"p_Kammer_2", "p2_chamber_Pa"},
                                                        {"Druck im Zylinder A", "p1_chamber_Pa"},
                                                        {"Zylinderanschluss B Druck", "p2_port_Pa"},
                                                        {"Druck Kolbenseite", "p1_port_Pa"},
                                                        {"Stangenseitendruck", "p2_port_Pa"},
                                                        {"cap end pressure", "p1_port_Pa"},
                                                        {"rod side chamber pressure", "p2_chamber_Pa"},
                                                        {"Versorgungsdruck", "p_supply_Pa"},
                                                        {"Netzdruck", "p_supply_Pa"},
                                                        {"p0", "p_supply_Pa"},
                                                        {"psupply", "p_supply_Pa"},
                                                        {"Kolbenweg", "x_m"},
                                                        {"Zylinderposition", "x_m"},
                                                        {"rod position", "x_m"},
                                                        {"s_ist", "x_m"},
                                                        {"s_soll", "x_ref_m"},
                                                        {"Sollwert Ventil", "u_V"},
                                                        {"Stellgr\u00f6\u00dfe", "u_V"},
                                                        {"Steuerspannung", "u_V"},
                                                        {"u_soll", "u_V"},
                                                        {"control voltage", "u_V"},
                                                        {"Reglerausgang", "u_V"},
                                                        {"Kraftsensor", "F_N"},
                                                        {"capteur de pression 2", "p2_port_Pa"},
                                                        {"Pression chambre A", "p1_chamber_Pa"},
                                                        {"Pression d'alimentation", "p_supply_Pa"},
                                                        {"Position du v\u00e9rin", "x_m"},
                                                        {"consigne de position", "x_ref_m"},
                                                        {"tension de commande", "u_V"},
                                                        {"Presi\u00f3n c\u00e1mara 1", "p1_chamber_Pa"},
                                                        {"sensor de presi\u00f3n B", "p2_port_Pa"},
                                                        {"Carrera", "x_m"},
                                                        {"v\u00e1lvula", "u_V"},
                                                        {"Fuerza", "F_N"},
                                                        {"Pressione camera 2", "p2_chamber_Pa"},
                                                        {"pressione di alimentazione", "p_supply_Pa"},
                                                        {"corsa cilindro", "x_m"},
                                                        {"tensione valvola", "u_V"},
                                                        {"press\u00e3o 1", "p1_port_Pa"},
                                                        {"Ci\u015bnienie A", "p1_port_Pa"},
                                                        {"zuigerpositie", "x_m"},
                                                        {"Uhrzeit", "t_s"},
                                                        {"header.stamp", "t_s"}}) {
    CAPTURE(name);
    CHECK(ours(name) == column);
  }
}

TEST_CASE("a port or a chamber without a word for pressure is one where its unit is a pressure's") {
  const TemporaryFolder folder;
  const auto first = [&](const std::string& name) {
    const std::string bytes = "t_s," + name + "\n0,6\n0.001,6\n0.002,6\n";
    return guess_columns(read_table(put_plain(folder.file("ports.csv"), bytes)))[1];
  };
  CHECK(first("Anschluss A [bar]").ours == "p1_port_Pa");
  CHECK(first("Anschluss A [bar]").factor == 1e5);
  CHECK(first("Kammer 2 [kPa]").ours == "p2_chamber_Pa");
  CHECK(first("Port B (psi)").ours == "p2_port_Pa");
  for (const char* name : {"Anschluss A", "Port B [V]", "Kammer 1 [mm]"}) CHECK(first(name).ours.empty());
}

TEST_CASE("units of pressure and length in their spellings") {
  const auto check_unit = [](const char* text, double factor, bool is_gauge = false) {
    CAPTURE(text);
    const std::optional<Unit> unit = unit_in(text);
    REQUIRE(unit);
    CHECK(unit->factor == Approx(factor));
    CHECK(unit->is_gauge == is_gauge);
  };
  for (const char* text : {"bar rel", "bar \u00fc", "bar\u00dc", "bar(g)", "BAR G", "barg", "bar gauge"})
    check_unit(text, 1e5, true);
  for (const char* text : {"bar abs.", "bara", "Bar(a)", "bar absolute"}) check_unit(text, 1e5);
  check_unit("kPa(g)", 1e3, true);
  check_unit("psi abs", 6894.757);
  check_unit("kg/cm\u00b2", 98066.5);
  check_unit("N/mm^2", 1e6);
  check_unit("mmHg", 133.322);
  check_unit("0.1 mm", 1e-4);
  check_unit("1/1000 m", 1e-3);
  check_unit("1e-3 m", 1e-3);
  check_unit("Millimeter", 1e-3);
  check_unit("mm.", 1e-3);
  check_unit("inch", 0.0254);
  check_unit("mil", 25.4e-6);
  for (const char* text : {"", "filtered", "3 mm", "raw x", "/"}) {
    CAPTURE(text);
    CHECK_FALSE(unit_in(text));
  }
}

TEST_CASE("numbers as accountants and Fortran write them") {
  double value = 0;
  for (const auto& [text, expected] : std::vector<std::pair<const char*, double>>{
           {"(0.5)", -0.5}, {"0.5-", -0.5}, {"1.5D-03", 1.5e-3}, {"-1.5d+02", -150}, {"2.5 E-01", 0.25}}) {
    CAPTURE(text);
    REQUIRE(number_in(text, '.', value));
    CHECK(value == Approx(expected));
  }
  for (const char* text : {"()", "(x)", "-", "1D3", "(-0.5)", "3-4", "E5", "1.5 mm"}) {
    CAPTURE(text);
    CHECK_FALSE(number_in(text, '.', value));
  }
}

TEST_CASE("files of other formats and matrices are named in a sentence of readable length") {
  using namespace std::string_literals;
  for (const auto& [bytes, words] :
       std::vector<std::pair<std::string, std::string>>{{"{\"t_s\": [0, 1]}", "JSON"},
                                                        {"[{\"t_s\": 0}]", "JSON"},
                                                        {"<?xml version='1.0'?>\n<a/>", "XML"},
                                                        {"<!DOCTYPE html>\n<table>", "HTML"},
                                                        {"Rar!\x1a\x07", "RAR"},
                                                        {"ARROW1\0\0"s, "Arrow"},
                                                        {"\x1f\x9d\x90", "compress"}})
    CHECK_THAT(refusal_of(bytes), Contains(words) && Contains("as text"));
  std::string wide = "t_s";
  for (int i = 0; i < 200000; ++i) wide += ",c";
  CHECK_THAT(refusal_of(wide + "\n"), Contains("200001 fields") && Contains("at most"));
  std::string names = "a0";
  for (int i = 1; i < 3000; ++i) names += fmt::format(",a{}", i);
  std::string row = names;
  std::replace(row.begin(), row.end(), 'a', '1');
  const TemporaryFolder folder;
  try {
    read_recordings(put_plain(folder.file("n.csv"), names + "\n" + row + "\n" + row + "\n"), std::nullopt, 1e-3);
    FAIL("no refusal");
  } catch (const InputError& error) { CHECK(std::string(error.what()).size() < 600); }
}
