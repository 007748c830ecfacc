#include "tools/plot/svg.hpp"

#include "tools/output/text_output.hpp"
#include "tools/plot/scales.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

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

namespace {

constexpr int kDecimals = 2;

void append_point(std::string& out, char command, const core::Point2& p) {
  out += command;
  append_fixed(out, p.x(), kDecimals);
  out += ' ';
  append_fixed(out, p.y(), kDecimals);
}

}  // namespace

std::string stroke(std::string_view colour, double width_px) {
  return "stroke=\"" + std::string(colour) + "\" stroke-width=\"" + fixed_text(width_px, kDecimals) + '"';
}

void PathData::move_to(const core::Point2& p) {
  append_point(text_, 'M', p);
}

void PathData::line_to(const core::Point2& p) {
  append_point(text_, 'L', p);
}

void PathData::segment(const core::Point2& a, const core::Point2& b) {
  move_to(a);
  line_to(b);
}

void PathData::plus(const core::Point2& centre, double half) {
  segment({centre.x() - half, centre.y()}, {centre.x() + half, centre.y()});
  segment({centre.x(), centre.y() - half}, {centre.x(), centre.y() + half});
}

void SvgWriter::open(std::string_view element) {
  body_ += '<';
  body_ += element;
}

void SvgWriter::number(std::string_view name, double value) {
  body_ += ' ';
  body_ += name;
  body_ += "=\"";
  append_fixed(body_, value, kDecimals);
  body_ += '"';
}

void SvgWriter::close(std::string_view attributes) {
  if (!attributes.empty()) body_ += ' ';
  body_ += attributes;
}

void SvgWriter::open_group(std::string_view attributes) {
  open("g");
  close(attributes);
  body_ += ">\n";
}

void SvgWriter::open_clipped_group(const PixelBox& box, std::string_view name) {
  body_ += "<clipPath id=\"" + std::string(name) + "\">\n";
  rect(box);
  body_ += "</clipPath>\n";
  open_group("clip-path=\"url(#" + std::string(name) + ")\"");
}

void SvgWriter::close_group() {
  body_ += "</g>\n";
}

void SvgWriter::line(const core::Point2& a, const core::Point2& b, std::string_view attributes) {
  open("line");
  number("x1", a.x());
  number("y1", a.y());
  number("x2", b.x());
  number("y2", b.y());
  close(attributes);
  body_ += "/>\n";
}

void SvgWriter::rect(const PixelBox& box, std::string_view attributes) {
  open("rect");
  number("x", box.left);
  number("y", box.top);
  number("width", box.width());
  number("height", box.height());
  close(attributes);
  body_ += "/>\n";
}

void SvgWriter::circle(const core::Point2& centre, double radius, std::string_view attributes) {
  open("circle");
  number("cx", centre.x());
  number("cy", centre.y());
  number("r", radius);
  close(attributes);
  body_ += "/>\n";
}

void SvgWriter::path(const PathData& data, std::string_view attributes) {
  if (data.empty()) return;
  open("path");
  body_ += " d=\"" + data.text() + '"';
  close(attributes);
  body_ += "/>\n";
}

void SvgWriter::text(const core::Point2& baseline, std::string_view words, std::string_view attributes) {
  open("text");
  number("x", baseline.x());
  number("y", baseline.y());
  close(attributes);
  body_ += '>';
  append_xml_text(body_, words);
  body_ += "</text>\n";
}

void SvgWriter::power(const core::Point2& baseline, std::string_view base, std::string_view exponent,
                      std::string_view attributes) {
  open("text");
  number("x", baseline.x());
  number("y", baseline.y());
  close(attributes);
  body_ += '>';
  append_xml_text(body_, base);
  body_ += "<tspan dy=\"-4\" font-size=\"8\">";
  append_xml_text(body_, exponent);
  body_ += "</tspan></text>\n";
}

std::string SvgWriter::finish(double width, double height) const {
  const std::string w = fixed_text(width, 0);
  const std::string h = fixed_text(height, 0);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
         w + "\" height=\"" + h + "\" viewBox=\"0 0 " + w + ' ' + h +
         "\" font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" font-size=\"11\" "
         "fill=\"none\">\n<rect width=\"" +
         w + "\" height=\"" + h + "\" fill=\"#ffffff\"/>\n" + body_ + "</svg>\n";
}

namespace {

constexpr double kTitle_px = 15.0;
constexpr double kSummary_px = 11.0;
// Bold letters are wider than the estimate for plain ones.
constexpr double kBold = 1.1;

}  // namespace

double draw_heading(SvgWriter& svg, const std::string& title, const std::vector<std::string>& summary,
                    const core::Point2& corner_px, double width_px) {
  double y = corner_px.y();
  if (!title.empty()) {
    for (const std::string& line : wrap_text(title, kBold * kTitle_px, width_px)) {
      svg.text({corner_px.x(), y + 14.0}, line,
               "font-size=\"15\" font-weight=\"bold\" fill=\"" + std::string(kInk) + '"');
      y += 20.0;
    }
  }
  for (const std::string& sentence : summary) {
    for (const std::string& line : wrap_text(sentence, kSummary_px, width_px)) {
      svg.text({corner_px.x(), y + 11.0}, line, "fill=\"" + std::string(kSoftInk) + '"');
      y += 15.0;
    }
  }
  return y;
}

tl::expected<void, OutputError> draw_png(const std::filesystem::path& svg, const std::filesystem::path& png) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::execlp("rsvg-convert", "rsvg-convert", "--zoom", "2", "--background-color", "white", "-o", png.c_str(),
             svg.c_str(), static_cast<char*>(nullptr));
    ::_exit(errno == ENOENT ? 127 : 126);
  }
  int status = 0;
  const bool has_ended = child > 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status);
  if (has_ended && WEXITSTATUS(status) == 0) {
    return {};
  }
  return tl::unexpected(
      OutputError{png.string() + ": rsvg-convert " +
                  (has_ended && WEXITSTATUS(status) == 127
                       ? "is not installed; apt install librsvg2-bin, or be content with the SVG"
                       : "could not draw it from " + svg.string())});
}

std::string is_picture_name(const std::string& name) {
  const std::filesystem::path ending = std::filesystem::path(name).extension();
  return ending == ".svg" || ending == ".png"
             ? std::string()
             : name + " is no picture that can be written: end it in .svg or .png";
}

std::vector<std::filesystem::path> picture_files(const std::filesystem::path& path) {
  std::filesystem::path svg = path;
  return path.extension() == ".png" ? std::vector{svg.replace_extension(".svg"), path} : std::vector{path};
}

tl::expected<void, OutputError> write_picture(const std::filesystem::path& path, std::string_view svg) {
  const std::vector<std::filesystem::path> files = picture_files(path);
  if (auto written = write_file(files.front(), svg); !written || files.size() == 1) {
    return written;
  }
  return draw_png(files.front(), path);
}

double draw_scale_bar(SvgWriter& svg, double px_per_m, const core::Point2& corner_px) {
  const double length_m = round_step_down(kScaleBarMax_px / px_per_m);
  const double length_px = length_m * px_per_m;
  const double y = corner_px.y() + 16.0;
  PathData bar;
  bar.segment({corner_px.x(), y}, {corner_px.x() + length_px, y});
  bar.segment({corner_px.x(), y - 4.0}, {corner_px.x(), y + 4.0});
  bar.segment({corner_px.x() + length_px, y - 4.0}, {corner_px.x() + length_px, y + 4.0});
  svg.path(bar, stroke(kInk, 1.4));
  svg.text({corner_px.x() + 0.5 * length_px, y - 6.0}, tick_text(length_m, length_m) + " m",
           "text-anchor=\"middle\" fill=\"" + std::string(kInk) + '"');
  return y + 6.0;
}

}  // namespace slamsensor::tools
