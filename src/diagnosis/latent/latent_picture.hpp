// The picture of what no name explains: a free function's course beside what the machine did, and what it goes with.
#pragma once
#include <string>
#include <vector>

#include "diagnosis/diagnosis.hpp"
#include "diagnosis/latent/latent_ranking.hpp"

namespace pneuservo {

/// A number in the unit that a reader has at hand: kPa, mV, ms, normal litres a minute.
struct HandyUnit {
  std::string unit;
  double factor;
};
HandyUnit handy_unit_of(const std::string& unit);

/// "0.8 N"; of a flow in kg/s and in normal litres a minute.
std::string size_text(double value, const std::string& unit);

/// The course of the best input of a ranking. `courses` are those of the model, for measured pressures.
UnknownPicture picture_of(const std::vector<ResidualRow>& rows, const LatentRanking& ranking, const RankedLatent& shown,
                          const std::vector<ResidualChannel>& channels, const std::vector<ResidualCourse>& courses);

/// Of time, position, speed, pressures and command the one that the points go with most, with the sizes at its ends.
std::string picture_words(const UnknownPicture& picture);

}  // namespace pneuservo
