#include "tools/plot/svg_writer.hpp"

#include "tools/output/number_text.hpp"
#include "tools/plot/xml_text.hpp"

namespace slamsensor::tools {
namespace {

constexpr int kDecimals = 2;

void append_point(std::string& out, char command, const core::Point2& p) {
  out += command;
  append_fixed(out, p.x(), kDecimals);
  out += ' ';
  append_fixed(out, p.y(), kDecimals);
}

}  // namespace

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

void SvgWriter::open_clipped_group(const Box& box, std::string_view name) {
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

void SvgWriter::rect(const Box& box, std::string_view attributes) {
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

}  // namespace slamsensor::tools
