// What stands in for a DA/AD board where the program was built without comedilib: a refusal that says so.
#if !defined(PNEUSERVO_HAS_COMEDI)
#include "comedi/comedi_board.hpp"

#include <stdexcept>

namespace pneuservo {

struct ComediBoard::Device {};

ComediBoard::ComediBoard(const ComediParameters& parameters, bool) {
  throw std::runtime_error(parameters.device +
                           ": this program was built without comedilib: install libcomedi-dev and build it again");
}

// Never called: there is no board.
ComediBoard::~ComediBoard() = default;
std::size_t ComediBoard::add_input(const std::string&, std::uint32_t, std::uint32_t, ComediReference) { return 0; }
std::size_t ComediBoard::add_output(const std::string&, std::uint32_t, std::uint32_t, ComediReference) { return 0; }
std::size_t ComediBoard::add_counter(const std::string&, std::uint32_t, std::uint32_t) { return 0; }
void ComediBoard::arm_watchdog() {}
void ComediBoard::disarm_watchdog() noexcept {}
bool ComediBoard::feed_watchdog() noexcept { return false; }
bool ComediBoard::read() noexcept { return false; }
bool ComediBoard::write() noexcept { return false; }
double ComediBoard::volts(std::size_t) const noexcept { return 0.0; }
bool ComediBoard::is_saturated(std::size_t) const noexcept { return true; }
void ComediBoard::set_volts(std::size_t, double) noexcept {}
double ComediBoard::set_volts_of(std::size_t) const noexcept { return 0.0; }
std::uint32_t ComediBoard::counts(std::size_t) const noexcept { return 0; }
std::uint32_t ComediBoard::last_count(std::size_t) const noexcept { return 0; }
std::vector<std::string> ComediBoard::description() const { return {}; }

}  // namespace pneuservo

#endif
