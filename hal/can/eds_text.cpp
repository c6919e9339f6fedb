// Writes the EDS of a node that this program is.
#include "can/eds_text.hpp"

#include <map>
#include <vector>

#include <fmt/format.h>

#include "config/version.hpp"

namespace pneuservo {
namespace {

struct Entry {
  std::uint8_t sub;
  const DictionaryEntry* entry;
};

/// CiA 301's numbers of the basic types.
int data_type(const DictionaryEntry& entry) {
  if (entry.is_text) return 0x0009;
  const int of_unsigned = entry.bits <= 8 ? 0x0005 : entry.bits <= 16 ? 0x0006 : 0x0007;
  return entry.is_signed ? of_unsigned - 3 : of_unsigned;
}

std::string default_value(const DictionaryEntry& entry, std::uint8_t node) {
  if (entry.is_text) return entry.text;
  if (entry.adds_node) return fmt::format("$NODEID+{:#x}", entry.value - node);
  return fmt::format("{:#x}", entry.value);
}

const char* access_type(const DictionaryEntry& entry) {
  if (entry.is_constant) return "const";
  if (!entry.can_read) return "wo";
  return entry.can_write ? "rw" : "ro";
}

std::string variable(const std::string& section, const std::string& name, const DictionaryEntry& entry,
                     std::uint8_t node) {
  return fmt::format(
      "\n[{}]\nParameterName={}\nObjectType=0x7\nDataType={:#06x}\nAccessType={}\nDefaultValue={}\nPDOMapping={}\n",
      section, name, data_type(entry), access_type(entry), default_value(entry, node), entry.can_map ? 1 : 0);
}

std::string object(std::uint16_t index, const std::vector<Entry>& entries, const CanopenNode& node) {
  if (entries.size() == 1 && entries[0].sub == 0)
    return variable(fmt::format("{:04X}", index), entries[0].entry->name, *entries[0].entry, node.node());
  std::string text = fmt::format("\n[{:04X}]\nParameterName={}\nObjectType=0x9\nSubNumber={}\n", index,
                                 node.dictionary().object_name(index), entries.size());
  for (const Entry& e : entries)
    text += variable(fmt::format("{:04X}sub{:X}", index, e.sub), e.entry->name, *e.entry, node.node());
  return text;
}

std::string listed(const char* section, const std::vector<std::uint16_t>& indices) {
  std::string text = fmt::format("\n[{}]\nSupportedObjects={}\n", section, indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) text += fmt::format("{}={:#06x}\n", i + 1, indices[i]);
  return text;
}

}  // namespace

std::string eds_text(const CanopenNode& node) {
  std::map<std::uint16_t, std::vector<Entry>> objects;
  node.dictionary().each([&](std::uint16_t index, std::uint8_t sub, const DictionaryEntry& entry) {
    objects[index].push_back({sub, &entry});
  });
  std::vector<std::uint16_t> mandatory, optional, own;
  std::string body;
  for (const auto& [index, entries] : objects) {
    const bool is_mandatory = index == 0x1000 || index == 0x1001 || index == 0x1018;
    const bool is_own = index >= 0x2000 && index < 0x6000;
    (is_mandatory ? mandatory : is_own ? own : optional).push_back(index);
    body += object(index, entries, node);
  }
  std::string text = fmt::format(
      "[FileInfo]\nFileName={0}.eds\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\nDescription={0}\n"
      "\n[DeviceInfo]\nVendorName=pneuservo\nVendorNumber=0\nProductName={0}\nProductNumber=0\nRevisionNumber=0\n"
      "OrderCode={1}\nBaudRate_10=1\nBaudRate_20=1\nBaudRate_50=1\nBaudRate_125=1\nBaudRate_250=1\nBaudRate_500=1\n"
      "BaudRate_800=1\nBaudRate_1000=1\nSimpleBootUpMaster=0\nSimpleBootUpSlave=1\nGranularity=8\n"
      "DynamicChannelsSupported=0\nGroupMessaging=0\nNrOfRXPDO=4\nNrOfTXPDO=4\nLSS_Supported=0\n",
      node.name(), version());
  return text + listed("MandatoryObjects", mandatory) + listed("OptionalObjects", optional) +
         listed("ManufacturerObjects", own) + body;
}

}  // namespace pneuservo
