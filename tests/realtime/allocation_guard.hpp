// Counts every allocation of the calling thread: the program's own malloc family stands before the C library's, so that
// operator new, containers inside shared libraries and plain malloc are all seen. Link allocation_guard.cpp.
#pragma once

namespace pneuservo {

/// malloc, calloc, realloc, free and the aligned forms, called by this thread since its start.
long allocation_calls() noexcept;

}  // namespace pneuservo
