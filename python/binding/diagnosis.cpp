// The diagnosis from Python: progress, Ctrl-C and cancelling while it works in a thread of its own.
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "binding.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/result_json.hpp"
#include "diagnosis/result_text.hpp"
#include "report/diagnosis_report.hpp"

namespace pneuservo::python {
namespace {

/// A diagnosis at work. The thread that called looks after it, for only there Python's signals arrive.
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

class Work {
 public:
  Work(const Rig& rig, std::vector<Recording> recordings, DiagnoseOptions options) {
    options.stop = [this] { return stop_.load(std::memory_order_relaxed); };
    options.progress = [this](double share, const std::string& what) {
      const std::lock_guard lock(mutex_);
      share_ = share, what_ = what, told_ = false;
    };
    {
      const std::lock_guard lock(living_works().mutex);
      living_works().works.insert(this);
    }
    thread_ = std::thread([this, rig, recordings = std::move(recordings), options = std::move(options)]() mutable {
      std::exception_ptr error;
      try {
        result_ = std::make_unique<Diagnosis>(diagnose(rig, std::move(recordings), options));
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
  std::unique_ptr<Diagnosis> result() {
    if (error_) std::rethrow_exception(error_);
    return std::move(result_);
  }

 private:
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable over_;
  bool done_ = false, told_ = true;
  double share_ = 0.0;
  std::string what_;
  std::unique_ptr<Diagnosis> result_;
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

struct Watchers {
  nb::object progress, cancel;
};

/// Tells what is new, and asks whether to go on. Ctrl-C may come in the callback, too.
bool goes_on(Work& work, const Watchers& by) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  const auto news = work.news();
  if (news && !by.progress.is_none() && by.progress(news->first, news->second).is(Py_False)) return false;
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

std::vector<Recording> taken(const nb::list& given, bool is_held_out) {
  std::vector<Recording> out;
  for (const nb::handle one : given) {
    out.push_back(nb::cast<const Recording&>(one));
    out.back().is_held_out = is_held_out;
  }
  return out;
}

std::unique_ptr<Diagnosis> run_diagnosis(const Config& config, const nb::list& recordings, const nb::list& held_out,
                                         int jobs, bool latent, const nb::object& progress, const nb::object& cancel) {
  std::vector<Recording> all = taken(recordings, false);
  for (Recording& one : taken(held_out, true)) all.push_back(std::move(one));
  DiagnoseOptions options;
  options.jobs = jobs;
  options.with_free_functions = latent;
  Work work(config.rig, std::move(all), std::move(options));
  const bool interrupted = look_after(work, {progress, cancel});
  try {
    return work.result();
  } catch (const DiagnosisStopped&) {
    if (interrupted) {
      PyErr_SetString(PyExc_KeyboardInterrupt, "diagnose: stopped before anything was known");
    } else {
      const nb::object stopped = nb::module_::import_("pneuservo.errors").attr("DiagnosisStopped");
      PyErr_SetString(stopped.ptr(), "diagnose: stopped before anything was known");
    }
    throw nb::python_error();
  }
}

}  // namespace

void bind_diagnosis(nb::module_& m) {
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&stop_all_work));
  nb::class_<Diagnosis>(m, "Diagnosis", "What a diagnosis found.")
      .def(
          "json", [](const Diagnosis& d) { return diagnosis_json(d).dump(); },
          "As the verb's --json (docs/diagnosis-results.md).")
      .def("text", &diagnosis_text, "As the program prints it.")
      .def(
          "write_report",
          [](const Diagnosis& d, const std::filesystem::path& path) { write_diagnosis_report(d, path.string()); },
          nb::arg("path"), "The self-contained HTML page.")
      .def_prop_ro("verdict",
                   [](const Diagnosis& d) { return std::string(verdict_names[static_cast<std::size_t>(d.verdict)]); })
      .def_ro("sentence", &Diagnosis::sentence, "The verdict for a reader.")
      .def_ro("stopped", &Diagnosis::stopped, "Ended early: this is what was known by then.")
      .def_ro("warnings", &Diagnosis::warnings)
      .def_prop_ro(
          "improved", [](const Diagnosis& d) { return Config{d.improved, d.rig + ", improved"}; },
          "The config with what was found.")
      .def("__repr__", [](const Diagnosis& d) { return "<pneuservo.Diagnosis: " + d.sentence + ">"; });
  m.def("diagnose", &run_diagnosis, nb::arg("config"), nb::arg("recordings"), nb::arg("held_out"), nb::arg("jobs"),
        nb::arg("latent"), nb::arg("progress").none(), nb::arg("cancel").none(), "See pneuservo.diagnose.");
}

}  // namespace pneuservo::python
