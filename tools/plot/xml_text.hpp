#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// `words` is appended so that it stands between XML tags or quotes as it is: markup is escaped, and every
/// byte that is not part of valid UTF-8 or not allowed in XML 1.0 becomes '?'.
void append_xml_text(std::string& out, std::string_view words);

/// An upper estimate of the width of `words` in the fonts the pictures name, px, for a font of `size_px`.
[[nodiscard]] double text_width_px(std::string_view words, double size_px);

/// `words` cut at spaces into lines that are at most `width_px` wide; a word that is wider stands alone.
/// Never empty.
[[nodiscard]] std::vector<std::string> wrap_text(std::string_view words, double size_px, double width_px);

}  // namespace slamsensor::tools
