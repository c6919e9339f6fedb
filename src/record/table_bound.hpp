// How much of a recording is held in memory.
#pragma once
#include <cstddef>
#include <string>

namespace pneuservo {

/// A quarter of the memory that the machine, its container and the process's own limit leave: besides the table there
/// are a run of it and what is computed of both.
std::size_t most_table_bytes();

/// Throws InputError where a file's values or its head take more than that up to a line.
void refuse_beyond(std::size_t most_bytes, std::size_t bytes, const std::string& path, std::size_t line);

}  // namespace pneuservo
