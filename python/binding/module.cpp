// The module pneuservo._core: its parts, and our errors as exceptions of Python.
#include <exception>
#include <stdexcept>

#include "binding.hpp"
#include "config/input_error.hpp"
#include "config/version.hpp"

namespace {

/// pneuservo.errors says what Python sees of an error.
void raise_ours(const std::exception_ptr& error, void*) {
  try {
    std::rethrow_exception(error);
  } catch (const pneuservo::InputError& input) {
    PyErr_SetString(nanobind::module_::import_("pneuservo.errors").attr("InputError").ptr(), input.what());
  }
}

}  // namespace

NB_MODULE(_core, m) {
  m.doc() =
      "The compiled part of pneuservo. Quantities are in SI units, which stand in the names; x_m is 0 at mid-stroke.";
  m.attr("__version__") = std::string(pneuservo::version());
  nanobind::register_exception_translator(raise_ours);
  nanobind::set_leak_warnings(false);  // threads that Python ends at its own end keep their objects
  pneuservo::python::bind_config(m);
  pneuservo::python::bind_axis(m);
  pneuservo::python::bind_law(m);
  pneuservo::python::bind_recording(m);
  pneuservo::python::bind_work(m);
  pneuservo::python::bind_diagnosis(m);
  pneuservo::python::bind_design(m);
}
