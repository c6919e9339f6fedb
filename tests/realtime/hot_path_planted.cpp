// Planted violations for tools/check-realtime: the tool must name every line marked here, or it proves nothing.
#include <mutex>
#include <vector>

#include <pneuservo/core/rt.hpp>

std::mutex planted_mutex;
void planted_unknown() noexcept;
inline void planted_deep(std::vector<double>& values) noexcept { values.push_back(1.0); }

double* planted_new() noexcept PNEUSERVO_NONBLOCKING { return new double(1.0); }  // planted
void planted_lock() noexcept PNEUSERVO_NONBLOCKING { planted_mutex.lock(); }  // planted
void planted_throw(bool wrong) noexcept PNEUSERVO_NONBLOCKING {
  if (wrong) throw 1;  // planted
}
void planted_indirect(std::vector<double>& values) noexcept PNEUSERVO_NONBLOCKING { planted_deep(values); }  // planted
void planted_call() noexcept PNEUSERVO_NONBLOCKING { planted_unknown(); }  // planted
