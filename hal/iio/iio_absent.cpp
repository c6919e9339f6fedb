// What stands in for Industrial I/O where the program was built without libiio: a refusal that says so.
#if !defined(PNEUSERVO_HAS_IIO)
#include "iio/iio_board.hpp"

#include <stdexcept>

namespace pneuservo {

struct IioBoard::Devices {};

IioBoard::IioBoard(bool, std::string) {
  throw std::runtime_error("hal.iio: this program was built without libiio: install libiio-dev and build it again");
}

// Never called: there is no board.
IioBoard::~IioBoard() = default;
std::size_t IioBoard::add_input(const std::string&, const IioPlace&) { return 0; }
std::size_t IioBoard::add_output(const std::string&, const IioPlace&) { return 0; }
void IioBoard::start_scans(const std::string&, double) {}
void IioBoard::time_readings(double) {}
Pace IioBoard::await_scan(std::int64_t) noexcept { return {}; }
bool IioBoard::read() noexcept { return false; }
bool IioBoard::write() noexcept { return false; }
double IioBoard::volts(std::size_t) const noexcept { return 0.0; }
bool IioBoard::is_saturated(std::size_t) const noexcept { return true; }
double IioBoard::age_s() const noexcept { return 0.0; }
void IioBoard::set_volts(std::size_t, double) noexcept {}
double IioBoard::set_volts_of(std::size_t) const noexcept { return 0.0; }
std::vector<std::string> IioBoard::description() const { return {}; }
std::vector<std::string> iio_devices() { return {"this program was built without libiio"}; }

}  // namespace pneuservo

#endif
