// The errors of one input, collected so that all of them are told at once.
#pragma once
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/input_error.hpp"

namespace pneuservo {

/// One sentence each, in the order of the lines that they name.
class InputErrors {
 public:
  /// Runs a step of reading and keeps what it throws; whether it threw nothing.
  template <class Step> bool collect(Step&& step) {
    try {
      std::forward<Step>(step)();
      return true;
    } catch (const InputError& error) {
      add(error.what());
      return false;
    }
  }
  /// One sentence, or several on lines of their own; a sentence that is there already is not told twice.
  void add(const std::string& sentences);
  std::size_t size() const { return sentences_.size(); }
  /// A top-level key that was meant by another that is told.
  void doubt(const std::string& top_key) { doubted_.insert(top_key); }
  /// Whether one of them is about this top-level key or a key below it, or it is doubted.
  bool concern(std::string_view top_key) const;
  /// Throws them all as one InputError, one a line.
  void throw_if_any() const;

 private:
  std::vector<std::string> sentences_;
  std::set<std::string, std::less<>> doubted_;
};

}  // namespace pneuservo
