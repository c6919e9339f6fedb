// Brings one CANopen node from anything to pre-operational with the config's PDOs, watchdog and substitute outputs.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "can/sdo_client.hpp"
#include "rig/can_channels.hpp"

namespace pneuservo {

class EdsFile;

/// A PDO as the node has it after the setup.
struct SetUpPdo {
  std::uint32_t id = 0;
  std::vector<CanObject> objects;
  /// First bit of an object; empty where it is not mapped.
  std::optional<unsigned> place_of(CanObject object) const noexcept;
  unsigned bits() const noexcept;
};

/// What the setup of a node needs to know.
struct NodeSetup {
  const Rig& rig;
  const std::vector<CanChannel>& channels;
  std::string name;
  const EdsFile* eds = nullptr;  ///< of the device, where the config names one
  bool has_output() const;
};

/// The node watches our heartbeat.
bool watches_us(const NodeSetup& setup);

/// All that SDO does before the loop runs; what is written is read back. Throws SdoError or std::runtime_error with one
/// sentence.
class NodeConfigurator {
 public:
  NodeConfigurator(SdoClient& sdo, const NodeSetup& setup);

  /// Profile, DCF values, watchdog over our heartbeat, its own heartbeat, emergencies, SYNC, substitute outputs.
  void write_parameters();
  /// The device's own word on errors (0x1001, 0x1003): none may be there before motion.
  void refuse_errors();
  /// Mapping and transmission of one PDO. Returns what the node has then.
  SetUpPdo set_up_pdo(const CanPdo& pdo);
  /// PDOs that no channel uses are turned off: they would take the bus's time.
  void turn_off_others(const std::vector<CanPdo>& used);
  /// What the device does without, in sentences for the user.
  const std::vector<std::string>& notes() const noexcept { return notes_; }
  /// A CiA 408 valve: activate_valve (fluid_valve.hpp) after the start.
  bool is_valve() const noexcept;
  /// Whether it sends a heartbeat, or answers guard requests instead.
  bool has_heartbeat() const noexcept { return has_heartbeat_; }
  bool is_guarded() const noexcept { return is_guarded_; }
  /// Counts after which an encoder begins at 0 again; 0: not known.
  double wrap_counts(const CanChannel& input);

 private:
  [[noreturn]] void refuse(const std::string& what) const;
  void note(const std::string& what);
  void check_profile();
  void check_identity();
  std::uint64_t measuring_range();
  void write_supervision();
  void write_guarding();
  void write_watchdog();
  void write_heartbeat();
  void write_emergency();
  void write_sync();
  void write_type(std::uint16_t parameters, bool by_event);
  /// Identifier and bit 31 in two steps: an identifier may not change while its PDO is valid.
  void write_identifier(std::uint16_t index, std::uint8_t sub, std::uint32_t wanted);
  bool is_set_up(std::uint16_t parameters, bool is_output, bool by_event, std::uint32_t timer_ms);
  bool turn_off(bool is_output, std::uint32_t number);
  void try_turn_off(const CanPdo& pdo);
  void write_dcf();
  void write_substitute(const CanChannel& output);
  void check_pressure_unit(const CanChannel& input);
  void write_mapping(std::uint16_t mapping, const std::vector<CanObject>& objects);
  std::vector<CanObject> read_mapping(std::uint16_t mapping);

  SdoClient& sdo_;
  const NodeSetup& setup_;
  const CanNodeParameters& node_;
  const CanBusParameters& bus_;
  std::vector<std::string> notes_;
  std::uint32_t profile_ = 0;  ///< as 0x1000 states it
  bool has_heartbeat_ = true, is_guarded_ = false;
};

}  // namespace pneuservo
