// The table of backends by name.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Makes the backend that `run --hal NAME` asks for. Throws InputError naming the known ones.
std::unique_ptr<Backend> make_backend(const std::string& name, const Rig& rig);
/// Names that make_backend knows.
std::vector<std::string> backend_names();

}  // namespace pneuservo
