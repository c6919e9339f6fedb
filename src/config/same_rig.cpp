// Equality of parameter structs and rigs, value by value, through the fields they declare.
#include "config/same_rig.hpp"

#include "config/reference_fields.hpp"

namespace pneuservo {

bool same_reference(const ReferenceSpec& a, const ReferenceSpec& b) {
  bool same = a.kind == b.kind;
  if (same) visit_reference(a.kind, FieldComparer{same}, a, b);
  return same;
}

bool same_rig(const Rig& a, const Rig& b) {
  bool same = a.kind == b.kind && same_section(a, b);
  for (const Signal signal : all_signals)
    same = same && same_section(a.sensor_effects[signal], b.sensor_effects[signal]);
  return same;
}

}  // namespace pneuservo
