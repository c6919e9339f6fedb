// What a diagnosis found: one result for text, JSON, page and code.
#pragma once
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo {

enum class Verdict { consistent, missing_physics, parameter_error, sensor_error, unknown };
inline constexpr std::array<std::string_view, 5> verdict_names{"consistent", "missing_physics", "parameter_error",
                                                               "sensor_error", "unknown"};

struct EstimatedParameter {
  std::string name;  ///< key of the effect's parameter; `value` for a parameter of the config
  double value = 0, standard_error = 0;
  bool is_at_bound = false;  ///< the end of what is looked for, which is not where the effect is none
};

/// One thing that is held to be true.
struct DiagnosisAnswer {
  std::string effect, element;
  double probability = 0;
  std::vector<EstimatedParameter> parameters;
  std::vector<std::string> ambiguous_with;  ///< names that these recordings cannot tell from this one
  double share = 0;                         ///< of the mismatch above the floor that it takes
  std::string note;
};

struct ElementShare {
  std::string element;
  double share = 0;
};

/// One explanation that was fitted in full.
struct RankedExplanation {
  std::vector<std::string> effects;  ///< none: the owner's model
  double probability = 0;
  double log_evidence_behind =
      0;  ///< of the best; for `consistent` of the owner's model, negative where a name fits better
};

/// Root mean square of simulation minus recording, in the channel's unit.
struct ChannelFit {
  std::string column;  ///< with unit: p1_port_Pa
  /// Root mean squares [unit]: `noise` is what noise and the model's own error make. Held out: NaN where none was
  /// simulated.
  double noise = 0, before = 0, after = 0, held_out_before = 0, held_out_after = 0;
  double correlation = 0;  ///< of neighbouring residual rows at the end: 0 is white
};

/// The smallest size of an effect that would have been named.
struct DetectableSize {
  std::string effect, parameter;
  double value = 0;
};

/// A parameter inside its tolerance whose best value is not the configured one.
struct MovedParameter {
  std::string path;
  double configured = 0, fitted = 0, tolerances = 0;  ///< tolerances: by how many
  bool is_at_end = false;  ///< of the range that its tolerance gives it
};

/// A recording to be made that tells rivals apart.
struct ProposedExperiment {
  ReferenceSpec reference;
  std::string setup;       ///< in words, where a change of the machine is needed
  std::vector<std::string> between;
  double separation = 0;   ///< predicted, in noise floors
  double duration_s = 0;
  std::vector<std::pair<std::string, double>> keys;  ///< the setup as config paths and values

  /// How the recording is to be diagnosed for the separation to hold.
  std::string use() const;
};

/// A span of a recording.
struct ComparedSpan {
  std::string recording;
  double from_s = 0, to_s = 0;
};

/// What of the recordings is compared.
struct Coverage {
  double recorded_s = 0;
  std::vector<ComparedSpan> spans;
  std::string choice;  ///< how the spans were chosen; empty: everything usable is compared
};

/// What is missing at one time, with its standard deviation, beside what the machine did then. NaN: not measured.
struct PicturePoint {
  int recording = 0;
  double time_s = 0, position_m = 0, velocity_mps = 0, command_V = 0, p1_Pa = 0, p2_Pa = 0;
  double mean = 0, deviation = 0;
};

/// The free function of time that stands best for what no name explains.
struct UnknownPicture {
  std::string element, what, unit;
  double gain = 0;   ///< in log evidence over the owner's model
  double level = 0;  ///< its standard deviation [unit]
  std::vector<PicturePoint> points;
  std::string words;  ///< what it goes with
};

/// A function by its points, fitted for what no name explains.
struct UnknownCurve {
  std::vector<std::string> effects;  ///< of the config: one table, or one for each direction
  std::vector<std::string> beside;   ///< names that it stands beside; none: the owner's model
  std::string over, over_unit, unit;
  struct Point {
    double place = 0, value = 0, standard_error = 0;
  };
  std::vector<Point> points;  ///< ascending
  double gain = 0;            ///< in log evidence over what it stands beside
  std::vector<ChannelFit> channels;
  Rig improved;  ///< the owner's config with it, as fitted
};

/// A free function of time at an element beside the owner's model; its size as its standard deviation.
struct FreeFunction {
  std::string element, what, unit;
  double gain = 0;         ///< in log evidence
  double level = 0;        ///< likeliest
  double memory_s = 0;
  double upper_level = 0;  ///< what is larger is excluded with 95 %
};

/// Machines as the answer has them, diagnosed in the same way.
struct SelfTest {
  int machines = 0, same = 0;        ///< played; with the same verdict and the same names
  std::vector<std::string> others;  ///< what was said of the others
};

struct Diagnosis {
  std::string rig;
  std::vector<std::string> recordings;
  Verdict verdict = Verdict::consistent;
  std::string sentence;  ///< the verdict for a reader
  std::vector<ElementShare> elements;
  std::vector<DiagnosisAnswer> answers;
  std::vector<DiagnosisAnswer> unsaid;  ///< behind `unknown`: the best name's effects, which `improved` has
  std::vector<RankedExplanation> candidates;
  std::vector<ChannelFit> channels;
  double held_out_ratio = 1, over_noise = 1;  ///< after over before, held out; after over noise: medians of channels
  /// Root mean squares over all channels, each in its floor: held out, after over before (NaN: nothing held out was
  /// simulated); fitted, after.
  double error_left = 1, floors_left = 1;
  double explained_share = 0;  ///< of the squared mismatch above the floor that the answers take
  std::vector<std::string> warnings;
  double admitted_s = 0, held_out_s = 0;
  Coverage coverage;
  std::vector<DetectableSize> detectable;
  std::vector<MovedParameter> moved;
  std::optional<UnknownPicture> picture;  ///< of `unknown`
  std::optional<UnknownCurve> curve;      ///< of what no name explains, where one was asked for
  std::vector<FreeFunction> functions;    ///< best first
  /// In log evidence over the best function beside the owner's model: the verdict's names alone, and names and a
  /// function together. NaN: there are no names, or no functions.
  double names_ahead = std::numeric_limits<double>::quiet_NaN(), names_bring = names_ahead;
  std::optional<ProposedExperiment> next_experiment;
  std::optional<SelfTest> self_test;  ///< where one was asked for and could be made
  bool stopped = false;  ///< ended early; what stands here is what was known by then

  Rig configured, improved;  ///< improved: the best model, as a config
  // For pictures: the compared rows with their residuals (in sigma), and whole courses.
  std::vector<ResidualChannel> residual_channels;
  std::vector<ResidualRow> rows;
  std::vector<double> residual_before, residual_after;
  std::vector<ResidualCourse> courses_before, courses_after;
  std::size_t hypotheses_tried = 0;
};

}  // namespace pneuservo
