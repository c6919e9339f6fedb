// The table of backends by name: a new one is one line here.
#include "backends.hpp"

#include <functional>
#include <map>

#include "composite/composite_backend.hpp"
#include "config/input_error.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {
namespace {

using Maker = std::function<std::unique_ptr<Backend>(const Rig&)>;
const std::map<std::string, Maker>& makers() {
  static const std::map<std::string, Maker> table{
      {"configured", [](const Rig& rig) { return std::make_unique<CompositeBackend>(rig); }},
      {"sim", [](const Rig& rig) { return std::make_unique<SimBackend>(rig, SimBackend::Has::sensors_of_the_config); }},
  };
  return table;
}

}  // namespace

std::unique_ptr<Backend> make_backend(const std::string& name, const Rig& rig) {
  const auto found = makers().find(name);
  if (found != makers().end()) return found->second(rig);
  std::string known;
  for (const auto& word : backend_names()) known += (known.empty() ? "" : ", ") + word;
  throw InputError("--hal: found '" + name + "', expected one of: " + known);
}

std::vector<std::string> backend_names() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : makers()) names.push_back(name);
  return names;
}

}  // namespace pneuservo
