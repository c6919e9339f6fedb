// Eigen reports its own allocations while they are forbidden. Include before any Eigen header, in builds with and without NDEBUG.
#pragma once
#ifdef EIGEN_CORE_H
#error "eigen_guard.hpp must come before Eigen"
#endif
#include <cstdio>
#include <cstdlib>

#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition)                                            \
  do {                                                                     \
    if (!(condition)) {                                                    \
      std::fprintf(stderr, "Eigen in the real-time section: %s\n", #condition); \
      std::_Exit(1);                                                       \
    }                                                                      \
  } while (false)
#include <Eigen/Core>

namespace pneuservo {

/// Eigen must not allocate while an object lives; the flag is the process's, not the thread's.
struct EigenNoAllocation {
  EigenNoAllocation() { Eigen::internal::set_is_malloc_allowed(false); }
  ~EigenNoAllocation() { Eigen::internal::set_is_malloc_allowed(true); }
};

}  // namespace pneuservo
