// A config of a new axis from the numbers of its data sheets: what the sheets do not say gets a typical value that says
// so.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One question of new-rig; its answer stands in the config as it was given.
struct SheetQuestion {
  std::string_view option;  ///< also its name on the command line
  std::string_view question;  ///< on a terminal
  std::string_view example;  ///< how an answer looks
  std::string_view typical;  ///< taken where the owner does not know; empty: must be answered
  std::string_view why;  ///< where the typical value comes from
};
inline constexpr std::array sheet_questions{
    SheetQuestion{"bore", "Bore of the cylinder", "32 mm", "", ""},
    SheetQuestion{"rod", "Diameter of its rod", "12 mm", "", ""},
    SheetQuestion{"stroke", "Stroke", "200 mm", "", ""},
    SheetQuestion{"mass", "Moving mass: piston, rod, carriage", "3 kg", "", ""},
    SheetQuestion{"payload-max", "Largest payload on it", "0 kg", "0 kg", "no payload"},
    SheetQuestion{"incline", "Angle of the axis, positive where x points up", "90 deg", "0 deg", "a horizontal axis"},
    SheetQuestion{"line-length", "Length of each hose from valve to cylinder", "3.5 m", "", ""},
    SheetQuestion{"line-diameter", "Inner diameter of the hoses", "4 mm", "", ""},
    SheetQuestion{"supply", "Supply pressure, gauge or absolute", "6 bar gauge", "", ""},
    SheetQuestion{"signal", "Signal of the proportional valve, end to end", "0 to 10 V", "0 to 10 V",
                  "the usual signal of five-port proportional valves"},
    SheetQuestion{"flow", "Nominal flow (6 to 5 bar) or sonic conductance of the open valve", "700 l/min", "", ""},
    SheetQuestion{"critical-ratio", "Critical pressure ratio b of the valve", "0.3", "0.3",
                  "spool valves have 0.2 to 0.4 (ISO 6358 sheets)"},
    SheetQuestion{"valve-frequency", "Frequency at which the spool lags by 90 deg", "100 Hz", "100 Hz",
                  "directly driven spools have 60 to 150 Hz"},
    SheetQuestion{"position-step", "Resolution of the position sensor", "0.01 mm", "0.01 mm",
                  "magnetic scales; 12 bits of 0 to 10 V over 200 mm are 0.05 mm"},
    SheetQuestion{"pressure-range", "Range of the pressure sensors at the valve's ports", "0 to 10 bar", "0 to 10 bar",
                  "the usual sensor of a 6 bar supply"},
    SheetQuestion{"pressure-bits", "Bits of their converter", "12", "12", "the least of usual converters"},
};

/// Answers by option; what is not answered is typical.
struct SheetAnswers {
  std::string name = "axis";
  std::array<std::string, sheet_questions.size()> answers;
  std::string speed, acceleration;  ///< of moves; empty: what the valve can feed
  const std::string& of(std::string_view option) const;
  std::string& of(std::string_view option);
};

/// Gains and motion, as numbers of the draft.
struct DraftNumbers {
  double force_gain_V_per_N = 1e-4, position_gain_N_per_m = 100.0, velocity_gain_Ns_per_m = 10.0;
  double feedforward_lead_s = 0.0, speed_mps = 0.01, acceleration_mps2 = 0.01;
  std::vector<std::string> notes;  ///< one comment line each, above the controller
};

/// The config as text.
std::string draft_text(const SheetAnswers& answers, const DraftNumbers& numbers);

/// The finished config: gains by margins, checked in simulation, and a motion that the valve can feed.
struct FinishedDraft {
  std::string text;
  std::vector<std::string> told;  ///< sentences for the owner
  bool is_fed = true;  ///< the error of the hardest motion stays within 2 % of its way
};
/// Throws InputError with the keys of all answers that cannot be read.
FinishedDraft finish_draft(const SheetAnswers& answers);

}  // namespace pneuservo
