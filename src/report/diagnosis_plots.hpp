// The plots of a diagnosis: courses before and after, the residual over time and against what the machine does.
#pragma once
#include <vector>

#include <report/html_page.hpp>

#include "diagnosis/diagnosis.hpp"

namespace pneuservo {

/// Number of recordings that courses and rows come from.
std::size_t recording_count(const Diagnosis& diagnosis);

/// Channels in the order of their root mean square residual in floors before, largest first.
std::vector<std::size_t> channels_by_mismatch(const Diagnosis& diagnosis);

/// Measured, simulated as configured, simulated as found. No curves where the recording lacks the channel.
Plot course_plot(const Diagnosis& diagnosis, std::size_t channel, std::size_t recording);
/// Simulation minus recording, before and after, with the noise floor as a band and the held-out stretches shaded.
Plot difference_plot(const Diagnosis& diagnosis, std::size_t channel, std::size_t recording);

/// What the residual is drawn against.
enum class ResidualAxis { position, velocity, command };
/// Binned means with their spread, in floors, before and after.
Plot residual_plot(const Diagnosis& diagnosis, std::size_t channel, ResidualAxis axis);

/// The course of what no name explains in one recording, with its band of two standard deviations.
Plot unknown_course_plot(const UnknownPicture& picture, int recording);
/// The same against position, velocity, pressures and command, as binned means with their spread.
std::vector<Plot> unknown_plots(const UnknownPicture& picture);
/// The points of a table with two standard errors.
Plot curve_plot(const UnknownCurve& curve);

}  // namespace pneuservo
