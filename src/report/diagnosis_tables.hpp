// The tables of a diagnosis; text, JSON and page carry the same numbers.
#pragma once
#include <report/table.hpp>

#include "diagnosis/diagnosis.hpp"

namespace pneuservo {

/// What was found: words, name, element, probability, share of the mismatch.
Table answers_table(const Diagnosis& diagnosis);
/// The compared spans of the recordings.
Table coverage_table(const Coverage& coverage);
/// Every estimated parameter of the answers with its standard error.
Table estimates_table(const Diagnosis& diagnosis);
/// Root mean square of simulation minus recording by channel, before and after, fitted and held out, beside the floor.
Table fit_table(const std::vector<ChannelFit>& channels);
/// Explanations that were fitted in full, best first.
Table candidates_table(const Diagnosis& diagnosis);
/// Parameters of the config that moved inside their tolerances.
Table moved_table(const Diagnosis& diagnosis);
/// The smallest size of each effect that would have been seen.
Table detectable_table(const Diagnosis& diagnosis);
/// Free functions of time at each element: what each is worth, how large it is, how large it could be.
Table functions_table(const Diagnosis& diagnosis);
/// The proposed recording: what it asks for.
Table experiment_table(const ProposedExperiment& experiment);

}  // namespace pneuservo
