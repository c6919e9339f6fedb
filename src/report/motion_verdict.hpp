// What the axis did, as one judgement: does it follow, lag, oscillate, touch an end stop, end by a fault.
#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>

#include <report/run_result.hpp>

namespace pneuservo {

/// Words of a verdict in JSON, in the order of `Following`.
inline constexpr std::array<std::string_view, 5> following_names{"not_judged", "rests", "follows", "lags",
                                                                 "does_not_follow"};

/// Largest error as a share of half the reference's travel up to which an axis follows: 10 dB below the reference, so a
/// tenth of its power. For a sine the share is the magnitude of the loop's sensitivity.
inline constexpr double follows_share = 0.316;
/// Share from which an axis does not follow: a sensitivity of -3 dB is the end of a loop's bandwidth.
inline constexpr double lags_share = 0.707;

/// Judges one run whose metrics stand (evaluate). Oscillation is sought from the evaluation window's start to the
/// run's end, contact with an end stop in all rows.
MotionVerdict judge_motion(const Rig& rig, const RunResult& run);

/// "the axis follows its reference", "... lags behind its reference", "... does not follow its reference", "the axis
/// rests".
std::string following_words(const MotionVerdict& verdict);
/// "3.45 % of the amplitude of 80 mm": the figure behind following_words; empty where there is none.
std::string share_words(const MotionVerdict& verdict);
/// Sentences on what went wrong beside the following: oscillation, end stop; each begins with a blank.
std::string trouble_words(const MotionVerdict& verdict, std::string_view subject = "It");
/// One word for the whole: "fault", "end_stop", "oscillates" or the word of the following.
std::string_view verdict_word(const MotionVerdict& verdict);

/// A length for a sentence, in mm or, below 0.1 mm, in µm.
std::string length_words(double value_m);

}  // namespace pneuservo
