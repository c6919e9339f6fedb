// Which column is which: by the path before a name, among several of one meaning, by stated units and gauge words.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/files.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/column_words.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

std::vector<ColumnGuess> guesses_of(const std::string& bytes) {
  const TemporaryFolder folder;
  return guess_columns(read_table(put_plain(folder.file("f.csv"), bytes)));
}

using Meanings = std::vector<std::string>;

Meanings meanings(const std::vector<ColumnGuess>& guesses) {
  Meanings out;
  for (const ColumnGuess& guess : guesses) out.push_back(guess.ours);
  return out;
}

/// Numbers that all move, for columns with these names.
std::string moving_rows(const std::string& names, char separator = ',') {
  std::string out;
  const auto columns = 1 + std::count(names.begin(), names.end(), separator);
  for (int row = 0; row < 5; ++row)
    for (int c = 0; c < columns; ++c)
      out += fmt::format("{}{}", c == 0 ? 0.001 * row : c + 0.1 * row, c + 1 < columns ? separator : '\n');
  return out;
}

Meanings meanings_of(const std::string& names, char separator = ',') {
  return meanings(guesses_of(names + "\n" + moving_rows(names, separator)));
}

}  // namespace

TEST_CASE("what stands before a name in a path says what kind of value it is") {
  const auto ours = [](const char* name) {
    const std::optional<ColumnWord> word = column_word(name);
    return word ? std::string(word->ours) : "none";
  };
  for (const auto& [name, column] :
       std::vector<std::pair<const char*, std::string>>{{"setpoint.position", "x_ref_m"},
                                                        {"actual.position", "x_m"},
                                                        {"ref.x", "x_ref_m"},
                                                        {"axis/set/position", "x_ref_m"},
                                                        {"cmd.x", "x_ref_m"},
                                                        {"field.desired.positions0", "x_ref_m"},
                                                        {"/ctrl/state/reference/positions", "x_ref_m"},
                                                        {"/ctrl/state/feedback/positions", "x_m"},
                                                        {"feedback.desired.position", "x_ref_m"},
                                                        {"reference.actual.position", "x_m"},
                                                        {"setpoint.valve.u", "u_V"},
                                                        {"/axis/state/position", "x_m"},
                                                        {"axis.id3.position", "x_m"},
                                                        {"start/time", "t_s"}}) {
    CAPTURE(name);
    CHECK(ours(name) == column);
  }
  for (const char* name :
       {"error.x", "velocity/x", "twist.linear.x", "imu.linear_acceleration.x", "wrench.force.x", "wrench.torque.x",
        "observer/x", "limits.p1", "setpoint.p1", "pilot/pA", "reference.error.x"}) {
    CAPTURE(name);
    CHECK(ours(name).empty());
  }
}

TEST_CASE("what is computed of a position, or belongs to another part or moment, is none") {
  for (const char* name :
       {"x/L", "x^2", "|x|", "x'", "x-x_ref", "p1/p2", "p1-p2", "Start position", "Home position", "x_old", "u_prev",
        "Brake valve", "Valve shutoff", "Pilot pressure A", "Exhaust pressure B", "Total force", "Initial position"}) {
    CAPTURE(name);
    const std::optional<ColumnWord> word = column_word(name);
    REQUIRE(word);
    CHECK(word->ours.empty());
  }
  for (const auto& [name, column] :
       std::vector<std::pair<const char*, std::string>>{{"x-Position", "x_m"},
                                                        {"Soll-Position", "x_ref_m"},
                                                        {"Time since start", "t_s"},
                                                        {"total time", "t_s"},
                                                        {"Wegaufnehmer", "x_m"},
                                                        {"Betriebsdruck", "p_supply_Pa"},
                                                        {"Inlet pressure", "p_supply_Pa"}}) {
    CAPTURE(name);
    REQUIRE(column_word(name));
    CHECK(column_word(name)->ours == column);
  }
}

TEST_CASE("of several columns with one meaning the one that is measured here is taken") {
  CHECK(meanings_of("t_s,Axis.Position,Axis.ActualPosition") == Meanings{"t_s", "", "x_m"});
  CHECK(meanings_of("t_s,model.x,sensor.x") == Meanings{"t_s", "", "x_m"});
  CHECK(meanings_of("t_s,model.x,model.u") == Meanings{"t_s", "x_m", "u_V"});
  CHECK(meanings_of("t_s,A1.pos,A1.u,A2.pos,A2.u,A2.pA,A2.pB") ==
        Meanings{"t_s", "", "", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa"});
  CHECK(meanings_of("t_s,Axis1 x,Axis1 u,Axis2 u,Axis2 x,Axis2 force") == Meanings{"t_s", "", "", "u_V", "x_m", "F_N"});
  CHECK(meanings_of("t_s,Position,Weg") == Meanings{"t_s", "x_m", ""});
  CHECK(meanings_of("t_s,x_m,Actual position [mm]") == Meanings{"t_s", "x_m", ""});
  const std::vector<ColumnGuess> still =
      guesses_of("t_s,Stroke [mm],Position [mm],p1 [bar],p1 [bar]\n0,300,1,,5\n0.001,300,2,,6\n0.002,300,3,,7\n");
  CHECK(still[1].ours.empty());
  CHECK(still[1].evidence == "as Position [mm], which is taken for x_m");
  CHECK(still[2].ours == "x_m");
  CHECK(still[3].ours.empty());
  CHECK(still[4].ours == "p1_port_Pa");
  CHECK(still[4].factor == 1e5);
}

TEST_CASE("of several axes all channels are one's, whatever the word or number that tells them apart") {
  const Meanings first{"t_s", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa", "", "", "", ""};
  for (const char* names :
       {"t_s,X_pos_mm,X_valve_V,X_pA_bar,X_pB_bar,Y_pos_mm,Y_valve_V,Y_pA_bar,Y_pB_bar",
        "t_s,pos_1,u_1,p1_1,p2_1,pos_2,u_2,p1_2,p2_2", "t_s,pos1,valve1,pA1,pB1,pos2,valve2,pA2,pB2",
        "t_s,Axis1Pos,Axis1Valve,Axis1PA,Axis1PB,Axis2Pos,Axis2Valve,Axis2PA,Axis2PB",
        "t_s,A.x,A.u,A.p1,A.p2,B.x,B.u,B.p1,B.p2", "t_s,Position A,Command A,P1 A,P2 A,Position B,Command B,P1 B,P2 B",
        "t_s,Position [1] (mm),Valve [1] (V),P1 [1] (bar),P2 [1] (bar),Position [2] (mm),Valve [2] (V),P1 [2] (bar),"
        "P2 [2] (bar)",
        "t_s,Cyl 1 Position (mm),Cyl 1 Command (V),Cyl 1 P1 (bar),Cyl 1 P2 (bar),Cyl 2 Position (mm),Cyl 2 Command (V),"
        "Cyl 2 P1 (bar),Cyl 2 P2 (bar)",
        "t_s,Achse links Position,Achse links Ventil,Achse links Druck A,Achse links Druck B,Achse rechts Position,"
        "Achse rechts Ventil,Achse rechts Druck A,Achse rechts Druck B",
        "t_s,Zylinder 1 Weg,Zylinder 1 Ventil,Zylinder 1 Druck A,Zylinder 1 Druck B,Zylinder 2 Weg,Zylinder 2 Ventil,"
        "Zylinder 2 Druck A,Zylinder 2 Druck B",
        "t_s,Position,Valve,pA,pB,Position 2,Valve 2,pA 2,pB 2",
        "t_s,Position [mm],Valve [V],pA [bar],pB [bar],Position [mm],Valve [V],pA [bar],pB [bar]"}) {
    CAPTURE(names);
    CHECK(meanings_of(names) == first);
  }
  CHECK(meanings_of("t_s,X_pos,X_valve,Y_pos,Y_valve,Y_p1,Y_p2,ps") ==
        Meanings{"t_s", "", "", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa", "p_supply_Pa"});
  CHECK(meanings_of("t_s,X_act_pos,X_set_pos,X_u,Y_act_pos,Y_set_pos,Y_u") ==
        Meanings{"t_s", "x_m", "x_ref_m", "u_V", "", "", ""});
}

TEST_CASE("sides, set points, second sensors and models are no axes") {
  const Meanings one{"t_s", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa"};
  for (const char* names : {"t_s,x,u,p1,p2", "t_s,pos_A,u_A,pA,pB", "t_s,Position,Valve,Pressure A,Pressure B",
                            "t_s,axis1.x,axis1.u,axis1.p1,axis1.p2"}) {
    CAPTURE(names);
    CHECK(meanings_of(names) == one);
  }
  CHECK(meanings_of("t_s,x_act,x_set,u_act,u_set,p1,p2") ==
        Meanings{"t_s", "x_m", "x_ref_m", "", "u_V", "p1_port_Pa", "p2_port_Pa"});
  CHECK(meanings_of("t_s,pos_1,pos_2,u,p1,p2") == Meanings{"t_s", "x_m", "", "u_V", "p1_port_Pa", "p2_port_Pa"});
  CHECK(meanings_of("t_s,x_raw,x_filt,p1_raw,p1_filt,p2_raw,p2_filt,u") ==
        Meanings{"t_s", "x_m", "", "p1_port_Pa", "", "p2_port_Pa", "", "u_V"});
  CHECK(meanings_of("t_s,plc.x,plc.u,daq.x,daq.p1,daq.p2") ==
        Meanings{"t_s", "", "u_V", "x_m", "p1_port_Pa", "p2_port_Pa"});
  CHECK(meanings_of("t_s,Chamber 1 pressure,Chamber 2 pressure,Port 1 pressure,Port 2 pressure,x,u") ==
        Meanings{"t_s", "p1_chamber_Pa", "p2_chamber_Pa", "p1_port_Pa", "p2_port_Pa", "x_m", "u_V"});
}

TEST_CASE("words that may be sides or numbers of sensors tell no axes where a signal is lost by them") {
  for (const auto& [names, ours] : std::vector<std::pair<const char*, Meanings>>{
           {"t_s,pos1_mm,pos2_mm,u_V,p1_bar,p2_bar,supply1_bar,supply2_bar",
            {"t_s", "x_m", "", "u_V", "p1_port_Pa", "p2_port_Pa", "p_supply_Pa", ""}},
           {"t_s,Position A [mm],Position B [mm],Valve A [V],Valve B [V],Pressure A [bar],Pressure B [bar]",
            {"t_s", "x_m", "", "u_V", "", "p1_port_Pa", "p2_port_Pa"}},
           {"t_s,pos_A,u_A,p_A,pos_B,u_B,p_B", {"t_s", "x_m", "u_V", "p1_port_Pa", "", "", "p2_port_Pa"}},
           {"t_s,x1_mm,x2_mm,u1_V,u2_V,p1_bar,p2_bar", {"t_s", "x_m", "", "u1_V", "u2_V", "p1_port_Pa", "p2_port_Pa"}},
           {"t_s,x 1,u 1,p1 1,x 2,p1 2,p2 2", {"t_s", "x_m", "u_V", "p1_port_Pa", "", "", "p2_port_Pa"}}}) {
    CAPTURE(names);
    const std::vector<ColumnGuess> guesses = guesses_of(std::string(names) + "\n" + moving_rows(names));
    CHECK(meanings(guesses) == ours);
    CHECK(axis_words(guesses).empty());
  }
  // Shared pressures are of no axis, and a command is never the other's.
  CHECK(meanings_of("t_s,X_pos_mm,Y_pos_mm,X_valve_V,Y_valve_V,pA_bar,pB_bar") ==
        Meanings{"t_s", "x_m", "", "u_V", "", "p1_port_Pa", "p2_port_Pa"});
}

TEST_CASE("two loggers of one axis lack nothing that one of them has, and two axes stay apart") {
  const auto taken_of = [](double other_gain) {
    std::string bytes = "t_s,PLC_x_mm,PLC_u_V,PLC_p1_bar,DAQ_x_mm,DAQ_p1_bar,DAQ_p2_bar\n";
    for (int i = 0; i < 50; ++i)
      bytes += fmt::format("{:.3f},{},{},{},{:.3f},{},{}\n", 0.001 * i, i, 0.1 * i, 5 + 0.01 * i,
                           other_gain * i + 0.1 * (i % 2), 5 + 0.01 * i, 6 - 0.01 * i);
    return guesses_of(bytes);
  };
  CHECK(meanings(taken_of(1)) == Meanings{"t_s", "x_m", "u_V", "p1_port_Pa", "", "", "p2_port_Pa"});
  CHECK(axis_words(taken_of(1)).empty());
  CHECK(meanings(taken_of(-1)) == Meanings{"t_s", "x_m", "u_V", "p1_port_Pa", "", "", ""});
  CHECK_THAT(axis_words(taken_of(-1)), Contains("\"PLC\" is taken, \"DAQ\" is left out"));
}

TEST_CASE("an axis without a number is told as one") {
  const std::vector<ColumnGuess> guesses =
      guesses_of("t_s,Position,Valve,Position 2,Valve 2\n0,1,1,1,1\n0.001,2,2,2,2\n0.002,3,3,3,3\n");
  CHECK(meanings(guesses) == Meanings{"t_s", "x_m", "u_V", "", ""});
  CHECK_THAT(guesses[1].evidence, Contains("of the axis without a number"));
  CHECK(guesses[3].evidence == "of axis \"2\", where the one without a number is taken");
  CHECK_THAT(axis_words(guesses), Contains("axes: the one without a number is taken, \"2\" is left out"));
}

TEST_CASE("which axis is taken and which are not is told once") {
  const std::vector<ColumnGuess> guesses =
      guesses_of("t_s,X_pos,X_valve,Y_pos,Y_valve\n0,1,1,1,1\n0.001,1,1,2,2\n0.002,1,1,3,3\n");
  CHECK(guesses[1].ours.empty());
  CHECK(guesses[3].ours == "x_m");
  CHECK(guesses[1].evidence == "of axis \"X\", where \"Y\" is taken");
  CHECK_THAT(axis_words(guesses), Contains("\"Y\" is taken, \"X\" is left out"));
  CHECK(axis_words(guesses_of("t_s,x,u\n0,1,1\n0.001,1,2\n")).empty());
}

TEST_CASE("ports 2 and 4 of a valve are the cylinder's, and 1 is the supply") {
  const Meanings ports{"t_s", "p1_port_Pa", "p2_port_Pa", "p_supply_Pa"};
  CHECK(meanings_of("t_s,p4 [bar],p2 [bar],p1 [bar]") == ports);
  CHECK(meanings_of("t_s,Port 4 [bar],Port 2 [bar],Port 1 [bar]") == ports);
  CHECK(meanings_of("t_s,p1 [bar],p2 [bar],p3 [bar],p4 [bar]") == Meanings{"t_s", "p1_port_Pa", "p2_port_Pa", "", ""});
  CHECK(meanings_of("t_s,p1 [bar],p2 [bar]") == Meanings{"t_s", "p1_port_Pa", "p2_port_Pa"});
  CHECK(guesses_of("t_s,p4 [bar],p2 [bar]\n0,5,6\n0.001,5,7\n")[1].factor == 1e5);
}

TEST_CASE("a unit that is stated is read, with its multiple, or asked about") {
  const auto first = [](const std::string& name) {
    return guesses_of("t_s;" + name + "\n0;1.5\n0.001;2.5\n0.002;3.5\n")[1];
  };
  for (const auto& [name, factor] : std::vector<std::pair<const char*, double>>{{"Position [0,01 mm]", 1e-5},
                                                                                {"Position [mm/10]", 1e-4},
                                                                                {"Position [mm*100]", 1e-5},
                                                                                {"Position [mm x 10]", 1e-4},
                                                                                {"Position x100 [mm]", 1e-5},
                                                                                {"Position_x10_mm", 1e-4},
                                                                                {"Position [?m]", 1e-6},
                                                                                {"Position [10^-3 mm]", 1e-6},
                                                                                {"Position 'mm'", 1e-3},
                                                                                {"Position [Zoll]", 0.0254},
                                                                                {"Position (mm) [avg]", 1e-3},
                                                                                {"101 <Position> (mm)", 1e-3},
                                                                                {"Valve [V*10]", 0.1},
                                                                                {"Pressure A [bar x10]", 1e4},
                                                                                {"Pressure A [N/cm2]", 1e4},
                                                                                {"Pressure A [kN/m\u00b2]", 1e3},
                                                                                {"Pressure A [lbf/in2]", 6894.757},
                                                                                {"Pressure A [kp/cm\u00b2]", 98066.5},
                                                                                {"Pressure A [at]", 98066.5},
                                                                                {"Pressure A [mmWS]", 9.80665},
                                                                                {"Pressure A [mH2O]", 9806.65},
                                                                                {"Pressure A [inH2O]", 249.08891},
                                                                                {"Position [mm abs]", 1e-3},
                                                                                {"Position [\u6beb\u7c73]", 1e-3},
                                                                                {"Pressure A [bar absolut]", 1e5},
                                                                                {"Pressure A [0-10 bar]", 1e5},
                                                                                {"Valve [\u00b110V]", 1},
                                                                                {"Valve [-10..10 V]", 1},
                                                                                {"Valve [+/-10 V]", 1},
                                                                                {"Pressure A [bar] (2)", 1e5}}) {
    CAPTURE(name);
    const ColumnGuess guess = first(name);
    CHECK_FALSE(guess.ours.empty());
    CHECK(guess.has_unit);
    CHECK(guess.factor == Approx(factor));
  }
  CHECK_THAT(first("Position [mm*100]").evidence, Contains("1 is taken for 1e-05 in SI"));
  for (const char* name : {"Position [LU]", "Pressure A [foo]", "Valve [foo]", "Position [inc]", "Position [digits]",
                           "Valve [digits]", "Pressure A [LSB]", "P1 [W]"}) {
    CAPTURE(name);
    CHECK(first(name).ours.empty());
    CHECK_THAT(first(name).evidence,
               Contains("no unit that is known: state its factor") || Contains("scale") || Contains("disagree"));
  }
  CHECK(first("Valve [\u2030]").factor == Approx(0.1));
  CHECK(first("Position [filtered]").ours == "x_m");
  CHECK(first("Position (set)").ours == "x_ref_m");
  CHECK(first("P1 (2)").ours == "p1_port_Pa");
  CHECK(guesses_of("Tick [125us];x [mm]\n0;1\n8;2\n16;3\n")[0].factor == Approx(125e-6));
  CHECK(guesses_of("t (x100us);x [mm]\n0;1\n10;2\n20;3\n")[0].factor == Approx(1e-4));
}

TEST_CASE("a word for gauge pressure may stand in the name as well as in the unit") {
  const auto first = [](const std::string& name) {
    return guesses_of("t_s;" + name + "\n0;1.5\n0.001;2.5\n0.002;3.5\n")[1];
  };
  for (const char* name : {"Gauge pressure A [bar]", "Pressure A gauge [bar]", "p1_bar_rel", "p1_bar_g", "p1_rel [bar]",
                           "\u00dcberdruck A [bar]", "Relativdruck A [bar]", "p1 [bar-g]", "p1 [bar, gauge]"}) {
    CAPTURE(name);
    CHECK(first(name).ours == "p1_port_Pa");
    CHECK(first(name).factor == 1e5);
    CHECK(first(name).offset == 101325);
  }
  for (const char* name : {"Pressure A abs [bar]", "p1_bar_abs", "p1_bar_a"}) {
    CAPTURE(name);
    CHECK(first(name).factor == 1e5);
    CHECK(first(name).offset == 0);
  }
  CHECK(first("Pressure A [at\u00fc]").offset == 101325);
}
