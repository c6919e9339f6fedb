// Long calls from Python: progress, Ctrl-C and cancelling while the work goes on in a thread of its own.
#include "work.hpp"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace pneuservo::python {
namespace {

class Work;

/// Works whose thread may still run. Python ends threads of its own at its end, wherever they are: none may be in here.
struct LivingWorks {
  std::mutex mutex;
  std::condition_variable none_left;
  std::set<Work*> works;
};
LivingWorks& living_works() {
  static LivingWorks living;
  return living;
}

/// A job at work. The thread that called looks after it, for only there Python's signals arrive.
class Work {
 public:
  explicit Work(const Job& job) {
    {
      const std::lock_guard lock(living_works().mutex);
      living_works().works.insert(this);
    }
    thread_ = std::thread([this, &job] {
      std::exception_ptr error;
      try {
        job([this] { return stop_.load(std::memory_order_relaxed); },
            [this](double share, const std::string& what) {
              const std::lock_guard lock(mutex_);
              share_ = share, what_ = what, told_ = false;
            });
      } catch (...) { error = std::current_exception(); }
      const std::lock_guard lock(mutex_);
      error_ = error, done_ = true;
      over_.notify_all();
    });
  }
  ~Work() {
    stop_ = true;
    {
      const nb::gil_scoped_release released;
      thread_.join();
    }
    const std::lock_guard lock(living_works().mutex);
    living_works().works.erase(this);
    living_works().none_left.notify_all();
  }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  void stop() { stop_ = true; }
  /// Some time later; whether it is over.
  bool wait() {
    const nb::gil_scoped_release released;
    std::unique_lock lock(mutex_);
    return over_.wait_for(lock, std::chrono::milliseconds(50), [this] { return done_; });
  }
  /// What is new since the last time.
  std::optional<std::pair<double, std::string>> news() {
    const std::lock_guard lock(mutex_);
    if (std::exchange(told_, true)) return std::nullopt;
    return std::pair(share_, what_);
  }
  void rethrow_error() {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable over_;
  bool done_ = false, told_ = true;
  double share_ = 0.0;
  std::string what_;
  std::exception_ptr error_;
  std::thread thread_;
};

/// Before Python ends: stops what runs, and waits until the threads that asked for it have left, 10 s at most.
void stop_all_work() {
  const nb::gil_scoped_release released;
  std::unique_lock lock(living_works().mutex);
  for (Work* work : living_works().works) work->stop();
  living_works().none_left.wait_for(lock, std::chrono::seconds(10), [] { return living_works().works.empty(); });
}

/// Tells what is new, and asks whether to go on. Ctrl-C may come in the callback, too.
bool goes_on(Work& work, const Watchers& by) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  const auto news = work.news();
  // In thousandths: what a reader prints has no roundings of sums.
  if (news && !by.progress.is_none() && by.progress(std::round(1e3 * news->first) / 1e3, news->second).is(Py_False))
    return false;
  return by.cancel.is_none() || !nb::cast<bool>(by.cancel.attr("is_set")());
}

/// Until the work is over; whether Ctrl-C ended it.
bool look_after(Work& work, const Watchers& by) {
  bool interrupted = false;
  while (!work.wait()) {
    try {
      if (!goes_on(work, by)) work.stop();
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_KeyboardInterrupt)) throw;
      interrupted = true;
      work.stop();
    }
  }
  return interrupted;
}

}  // namespace

bool watched(const char* call, const Watchers& by, const Job& job) {
  Work work(job);
  const bool interrupted = look_after(work, by);
  try {
    work.rethrow_error();
  } catch (const DiagnosisStopped&) {
    const nb::object stopped = nb::module_::import_("pneuservo.errors").attr("DiagnosisStopped");
    PyErr_SetString(interrupted ? PyExc_KeyboardInterrupt : stopped.ptr(),
                    fmt::format("{}: stopped before anything was known", call).c_str());
    throw nb::python_error();
  }
  return interrupted;
}

void raise_interrupt(const char* call) {
  PyErr_SetString(PyExc_KeyboardInterrupt, fmt::format("{}: interrupted when all was done", call).c_str());
  throw nb::python_error();
}

void bind_work(nb::module_&) { nb::module_::import_("atexit").attr("register")(nb::cpp_function(&stop_all_work)); }

}  // namespace pneuservo::python
