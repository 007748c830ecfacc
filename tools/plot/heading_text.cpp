#include "tools/plot/heading_text.hpp"

#include "tools/plot/palette.hpp"
#include "tools/plot/xml_text.hpp"

namespace slamsensor::tools {
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

}  // namespace slamsensor::tools
