#include "tools/input/pcd_entries.hpp"

#include "tools/input/pcd_header.hpp"
#include "tools/input/text.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

using Status = tl::expected<void, InputError>;

std::optional<std::size_t> key_of(std::string_view word) {
  if (same_but_for_case(word, "COLUMNS")) {  // what version 0.5 called FIELDS
    return kFields;
  }
  const auto found = std::find_if(kPcdKeys.begin(), kPcdKeys.end(),
                                  [&](std::string_view key) { return same_but_for_case(word, key); });
  return found == kPcdKeys.end() ? std::nullopt
                                 : std::optional(static_cast<std::size_t>(found - kPcdKeys.begin()));
}

Status take_entry(const LineReader& lines, std::string_view name, PcdEntries& entries) {
  std::string_view rest = lines.line();
  const std::string_view word = take_word(rest);
  const std::optional<std::size_t> key = key_of(word);
  if (!key) {
    return refuse_line(name, lines.number(),
                       in_quotes(word) + " is not a key of a PCD header; is this a PCD file?");
  }
  PcdEntry& entry = entries.of_key[*key];
  if (entry.line != 0) {
    return refuse_line(
        name, lines.number(),
        std::string(kPcdKeys[*key]) + " is already in line " + std::to_string(entry.line) + "; remove one");
  }
  entry.line = lines.number();
  for (std::string_view value = take_word(rest); !value.empty(); value = take_word(rest)) {
    if (entry.words.size() == kPcdFieldsMax) {
      return refuse_line(name, entry.line,
                         "has more than " + std::to_string(kPcdFieldsMax) + " values; leave fields out");
    }
    entry.words.push_back(value);
  }
  return {};
}

}  // namespace

tl::expected<PcdEntries, InputError> read_pcd_entries(std::string_view bytes, std::string_view name) {
  if (auto checked = check_encoding(bytes, name); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  PcdEntries entries;
  LineReader lines(bytes.substr(0, kPcdHeaderBytesMax));
  while (lines.next() && (lines.ended() || lines.consumed_bytes() == bytes.size())) {
    if (auto taken = take_entry(lines, name, entries); !taken) {
      return tl::unexpected(std::move(taken.error()));
    }
    entries.end_bytes = lines.consumed_bytes();
    entries.last_line = lines.number();
    if (entries.of_key[kData].line != 0) {
      return entries;
    }
  }
  return refuse(name, "no DATA line in its first " +
                          std::to_string(std::min(bytes.size(), kPcdHeaderBytesMax)) +
                          " bytes; is this a PCD file, and is it complete?");
}

tl::expected<void, InputError> check_pcd_entries(const PcdEntries& entries, std::string_view name) {
  for (const PcdKey key : {kFields, kSize, kType, kWidth, kHeight, kPoints}) {
    if (entries.of_key[key].line == 0) {
      return refuse(name, "the header has no " + std::string(kPcdKeys[key]) + " line; add it before DATA");
    }
  }
  return {};
}

}  // namespace slamsensor::tools
