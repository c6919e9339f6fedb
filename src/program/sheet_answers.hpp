// What new-rig asks for, and the answers as lines of a config.
#pragma once
#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Kinds of rig that a question is about.
enum class AskedOf { both, cylinder, pressure };

/// One question of new-rig; its answer stands in the config as it was given.
struct SheetQuestion {
  std::string_view option;  ///< also its name on the command line
  std::string_view question;  ///< on a terminal
  std::string_view example;  ///< how an answer looks
  std::string_view typical;  ///< taken where the owner does not know; empty: must be answered
  std::string_view why;  ///< where the typical value comes from
  AskedOf asked_of = AskedOf::both;
};
inline constexpr std::array sheet_questions{
    SheetQuestion{"bore", "Bore of the cylinder", "32 mm", "", "", AskedOf::cylinder},
    SheetQuestion{"rod", "Diameter of its rod", "12 mm", "", "", AskedOf::cylinder},
    SheetQuestion{"stroke", "Stroke", "200 mm", "", "", AskedOf::cylinder},
    SheetQuestion{"mass", "Moving mass: piston, rod, carriage", "3 kg", "", "", AskedOf::cylinder},
    SheetQuestion{"payload-max", "Largest payload on it", "0 kg", "0 kg", "no payload", AskedOf::cylinder},
    SheetQuestion{"incline", "Angle of the axis, positive where x points up", "90 deg", "0 deg", "a horizontal axis",
                  AskedOf::cylinder},
    SheetQuestion{"volume", "Volume behind the hose", "0.5 l", "", "", AskedOf::pressure},
    SheetQuestion{"line-length", "Length of each hose from the valve", "3.5 m", "", ""},
    SheetQuestion{"line-diameter", "Inner diameter of the hoses", "4 mm", "", ""},
    SheetQuestion{"supply", "Supply pressure, gauge or absolute", "6 bar gauge", "", ""},
    SheetQuestion{"signal", "Signal of the proportional valve, end to end", "0 to 10 V", "0 to 10 V",
                  "the usual signal of proportional valves"},
    SheetQuestion{"flow", "Nominal flow (6 to 5 bar) or sonic conductance of the open valve", "700 l/min", "", ""},
    SheetQuestion{"critical-ratio", "Critical pressure ratio b of the valve", "0.3", "0.3",
                  "spool valves have 0.2 to 0.4 (ISO 6358 sheets)"},
    SheetQuestion{"valve-frequency", "Frequency at which the spool lags by 90 deg", "100 Hz", "100 Hz",
                  "directly driven spools have 60 to 150 Hz"},
    SheetQuestion{"position-step", "Resolution of the position sensor", "0.01 mm", "0.01 mm",
                  "magnetic scales; 12 bits of 0 to 10 V over 200 mm are 0.05 mm", AskedOf::cylinder},
    SheetQuestion{"pressure-range", "Range of the pressure sensor at each port of the valve", "0 to 10 bar",
                  "0 to 10 bar", "the usual sensor of a 6 bar supply"},
    SheetQuestion{"pressure-bits", "Bits of their converter", "12", "12", "the least of usual converters"},
};

/// Answers by option; what is not answered is typical.
struct SheetAnswers {
  RigKind kind = RigKind::cylinder;
  std::string name = "axis";
  std::array<std::string, sheet_questions.size()> answers;
  std::string speed, acceleration;  ///< of moves; empty: what the valve can feed
  std::string rate;                 ///< of a pressure; empty: the same
  std::string switching_on, switching_off;  ///< times of two on/off valves; empty: a proportional valve
  const std::string& of(std::string_view option) const;
  std::string& of(std::string_view option);
  bool are_asked(const SheetQuestion& question) const noexcept {
    return question.asked_of == AskedOf::both ||
           (question.asked_of == AskedOf::pressure) == (kind == RigKind::pressure);
  }
};

/// The answer, or the typical one.
std::string answer_of(const SheetAnswers& answers, std::string_view option);
/// The same in SI; 0 where it cannot be read.
double quantity_of(const SheetAnswers& answers, std::string_view option, std::string_view unit);
/// A line of the config with its comment; a value that is typical says why.
std::string sheet_line(const SheetAnswers& answers, std::string_view key, std::string_view option);
/// The key of the valve's flow: nominal_flow or sonic_conductance.
std::string_view flow_key(const SheetAnswers& answers);
/// What begins every config that new-rig writes.
std::string draft_head(const SheetAnswers& answers);

}  // namespace pneuservo
