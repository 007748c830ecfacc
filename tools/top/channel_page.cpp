#include "tools/top/channel_page.hpp"

#include "tools/output/number_text.hpp"
#include "tools/spy/known_types.hpp"

#include <cstdio>
#include <iterator>

namespace slamsensor::tools {
namespace {

std::string line_of(const char* channel, const std::string& type, const ChannelRecord& record,
                    const ChannelTable::Rate& rate, hal::Stamp now) {
  char text[256];
  std::snprintf(text, sizeof text, "%-24s %-24s %8s %9s %9s %10s", channel, type.c_str(),
                fixed_text(rate.messages_hz, 1).c_str(), amount_text(rate.bytes_per_s).c_str(),
                std::to_string(record.messages).c_str(), duration_text(now - record.last).c_str());
  return text;
}

std::string dump_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min<std::size_t>(bytes.size(), 24))) {
    char two[4];
    std::snprintf(two, sizeof two, "%02x ", byte);
    text += two;
  }
  return text + (bytes.size() > 24 ? "..." : "");
}

}  // namespace

TextLines channel_lines(const ChannelTable& table, std::size_t selected, hal::Stamp now) {
  char heading[128];
  std::snprintf(heading, sizeof heading, "%-24s %-24s %8s %9s %9s %10s", "channel", "type", "per s",
                "bytes/s", "messages", "last");
  TextLines lines = {{heading, CellStyle::Bold}};
  std::size_t number = 0;
  for (const auto& [name, record] : table.channels()) {
    lines.push_back(
        {line_of(name.c_str(), lcm_type_text(record.last_message), record, table.rate(name, now), now),
         number++ == selected ? CellStyle::Inverse : CellStyle::Plain});
  }
  if (table.channels().empty()) {
    lines.push_back({"nothing heard yet", CellStyle::Dim});
  }
  if (table.left_out() > 0) {
    lines.push_back(
        {"more channels than are shown: " + std::to_string(table.left_out()) + " messages left out",
         CellStyle::Warning});
  }
  return lines;
}

TextLines message_lines(const ChannelTable& table, std::size_t selected) {
  if (selected >= table.channels().size()) {
    return {};
  }
  const auto& [name, record] = *std::next(table.channels().begin(), static_cast<std::ptrdiff_t>(selected));
  TextLines lines = {
      {name + ": " + lcm_type_text(record.last_message) + ", " + std::to_string(record.last_bytes) + " bytes",
       CellStyle::Bold}};
  for (std::string& line : lcm_message_lines(record.last_message)) {
    lines.push_back({"  " + std::move(line)});
  }
  if (lines.size() == 1) {
    lines.push_back({"  " + dump_of(record.last_message)});
  }
  return lines;
}

}  // namespace slamsensor::tools
