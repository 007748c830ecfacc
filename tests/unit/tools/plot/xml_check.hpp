#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Why `document` is not well-formed XML of the simple kind the pictures are made of (elements, quoted
/// attributes, five named entities), or an empty string.
inline std::string xml_fault(std::string_view document) {
  const auto text_fault = [](std::string_view text) {
    for (std::size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
      bool is_entity = false;
      for (const std::string_view name : {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"}) {
        is_entity = is_entity || text.substr(at, name.size()) == name;
      }
      if (!is_entity) return true;
    }
    return false;
  };
  constexpr std::string_view kDeclaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  if (!document.starts_with(kDeclaration)) return "no declaration";
  document.remove_prefix(kDeclaration.size());
  std::vector<std::string> open;
  int roots = 0;
  while (!document.empty()) {
    const std::size_t start = document.find('<');
    if (text_fault(document.substr(0, start))) return "bare & in text";
    if (start == std::string_view::npos) break;
    const std::size_t end = document.find('>', start);
    if (end == std::string_view::npos) return "tag without end";
    std::string_view tag = document.substr(start + 1, end - start - 1);
    document.remove_prefix(end + 1);
    if (tag.find('<') != std::string_view::npos || text_fault(tag)) return "markup in a tag";
    int quotes = 0;
    for (const char c : tag) quotes += c == '"' ? 1 : 0;
    if (quotes % 2 != 0) return "odd quotes in <" + std::string(tag) + ">";
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return "unexpected <" + std::string(tag) + ">";
      open.pop_back();
      continue;
    }
    if (open.empty() && ++roots > 1) return "two roots";
    if (!tag.ends_with('/')) open.emplace_back(tag.substr(0, tag.find(' ')));
  }
  return open.empty() && roots == 1 ? "" : "unclosed element";
}

}  // namespace slamsensor::tools
