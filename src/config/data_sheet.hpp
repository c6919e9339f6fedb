// Keys of data sheets beside the SI keys of a config: values with units, and what follows from several of them.
#pragma once
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "config/config_tree.hpp"
#include "config/input_errors.hpp"

namespace pneuservo {

/// What the reading of a config carries along.
struct ReadContext {
  const Rig& rig;       ///< as far as it is read: sections stand in the order of the visits
  InputErrors& errors;
};

/// One way in which a data sheet states what SI keys say; for a section that has all the keys it gives.
struct DataSheetForm {
  std::vector<Field> keys;                  ///< of the data sheet
  std::vector<std::string_view> gives;      ///< SI keys of the section
  std::string_view rule;                    ///< how, in words
};
/// The forms that a section with these fields has.
std::vector<DataSheetForm> forms_of(const std::vector<Field>& fields);

/// Replaces data-sheet keys of a section by SI keys where they stand; what cannot be read goes to the context's errors.
/// Returns the keys that are not to be missed because their data-sheet form was stated wrongly.
std::set<std::string> translate_data_sheet(ConfigNode& map, const std::string& path, const std::vector<Field>& fields,
                                           ReadContext& context);

}  // namespace pneuservo
