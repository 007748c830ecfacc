#include "tools/plot/xml_text.hpp"

#include <algorithm>
#include <cstdint>

namespace slamsensor::tools {
namespace {

bool is_continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

std::size_t sequence_length(unsigned char lead) {
  if (lead < 0x80U) return 1;
  if (lead >= 0xC2U && lead <= 0xDFU) return 2;
  if (lead >= 0xE0U && lead <= 0xEFU) return 3;
  if (lead >= 0xF0U && lead <= 0xF4U) return 4;
  return 0;
}

std::uint32_t decode(std::string_view sequence) {
  const auto lead = static_cast<unsigned char>(sequence.front());
  if (sequence.size() == 1) return lead;
  std::uint32_t code = lead & (0x7FU >> sequence.size());
  for (const char c : sequence.substr(1)) code = (code << 6U) | (static_cast<unsigned char>(c) & 0x3FU);
  return code;
}

// The characters of XML 1.0, section 2.2, less encodings that are longer than they need be.
bool is_xml_character(std::uint32_t code, std::size_t length) {
  if (length == 1) return code >= 0x20U || code == '\t' || code == '\n' || code == '\r';
  if (length == 3 && code < 0x800U) return false;
  if (length == 4 && code < 0x10000U) return false;
  return code <= 0x10FFFFU && !(code >= 0xD800U && code <= 0xDFFFU) && code != 0xFFFEU && code != 0xFFFFU;
}

// The bytes of the character that `words` begins with, none if it begins with something else. `words` is not
// empty.
std::size_t character_length(std::string_view words) {
  const std::size_t length = sequence_length(static_cast<unsigned char>(words.front()));
  if (length == 0 || length > words.size()) return 0;
  const std::string_view sequence = words.substr(0, length);
  if (!std::all_of(sequence.begin() + 1, sequence.end(), is_continuation)) return 0;
  return is_xml_character(decode(sequence), length) ? length : 0;
}

void append_character(std::string& out, std::string_view character) {
  switch (character.front()) {
    case '&':
      out += "&amp;";
      break;
    case '<':
      out += "&lt;";
      break;
    case '>':
      out += "&gt;";
      break;
    case '"':
      out += "&quot;";
      break;
    default:
      out += character;
  }
}

// Of the widest of the fonts (DejaVu Sans), in ems.
double character_width_em(char c) {
  constexpr std::string_view kNarrow = "ijl.,:;'|!I ()[]/ft";
  constexpr std::string_view kWide = "mwMW@%+=<>~";
  if (kNarrow.find(c) != std::string_view::npos) return 0.40;
  if (kWide.find(c) != std::string_view::npos) return 0.99;
  return c >= 'A' && c <= 'Z' ? 0.76 : 0.64;
}

}  // namespace

void append_xml_text(std::string& out, std::string_view words) {
  while (!words.empty()) {
    const std::size_t length = character_length(words);
    if (length == 0) {
      out += '?';
    } else {
      append_character(out, words.substr(0, length));
    }
    words.remove_prefix(std::max<std::size_t>(length, 1));
  }
}

double text_width_px(std::string_view words, double size_px) {
  double width_em = 0.0;
  for (const char c : words) {
    if (!is_continuation(c)) width_em += character_width_em(c);
  }
  return width_em * size_px;
}

std::vector<std::string> wrap_text(std::string_view words, double size_px, double width_px) {
  std::vector<std::string> lines(1);
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    const std::string word(words.substr(0, end));
    words.remove_prefix(std::min(end + 1, words.size()));
    if (word.empty()) continue;
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (text_width_px(line + ' ' + word, size_px) <= width_px) {
      line += ' ' + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

}  // namespace slamsensor::tools
