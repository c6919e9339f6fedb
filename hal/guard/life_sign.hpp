// Signs of life between the loop and `pneuservo guard`: a page of memory that both processes map.
#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What the loop wants of the guard.
enum class GuardOrder : std::uint32_t { idle, watch, make_safe };

/// A stopped or killed process leaves its last numbers here: they stand still, which is what the other looks for.
struct LifeSign {
  static constexpr std::uint32_t known_layout = 0x50'47'00'01;
  std::atomic<std::uint32_t> layout{};
  std::atomic<std::uint32_t> order{};    ///< GuardOrder, by the loop
  std::atomic<std::uint32_t> session{};  ///< runs so far, by the loop
  std::atomic<std::uint32_t> tripped{};  ///< session in which the guard acted on its own
  std::atomic<std::int32_t> loop_process{}, guard_process{};
  std::atomic<std::uint64_t> loop_beats{}, guard_beats{};
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "two processes share these");
};

/// The page of hal.guard, by its name.
class LifeSignPage {
 public:
  /// The guard's side makes the page and is the only guard of that name; the loop's side needs it there with a guard.
  /// Throws std::runtime_error with the way to mend it.
  enum class Side { guard, loop };
  LifeSignPage(const Rig& rig, Side side);
  ~LifeSignPage();
  LifeSignPage(const LifeSignPage&) = delete;
  LifeSignPage& operator=(const LifeSignPage&) = delete;

  LifeSign& sign() noexcept { return *sign_; }
  const std::string& name() const noexcept { return name_; }

 private:
  void open_as_guard();
  void open_as_loop(const Rig& rig);
  void map();

  std::string name_;
  Side side_;
  int file_ = -1;
  LifeSign* sign_ = nullptr;
};

/// The name by which run and guard of a rig find each other.
std::string guard_name(const Rig& rig);

}  // namespace pneuservo
