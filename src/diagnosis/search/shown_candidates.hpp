// Names that recordings cannot show are not tried.
#pragma once
#include <vector>

#include "diagnosis/search/candidates.hpp"

namespace pneuservo {

/// Those whose `shown_by` the recordings have.
std::vector<Candidate> shown_candidates(std::vector<Candidate> candidates, const std::vector<ResidualRow>& rows);

}  // namespace pneuservo
