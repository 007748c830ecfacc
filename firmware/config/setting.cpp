#include "firmware/config/setting.hpp"

#include "firmware/config/rows/setting_rows.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

/// In the order of the file.
const std::vector<SettingRows>& rows() {
  static const std::vector<SettingRows> kRows = {
      head_rows(),   pan_tilt_rows(), rangefinder_rows(), point_laser_rows(), inclination_rows(), scan_rows(),
      method_rows(), input_rows(),    output_rows(),      daemon_rows(),      gpio_rows()};
  return kRows;
}

template <typename T, typename Rows>
std::vector<T> joined(Rows SettingRows::*part) {
  std::vector<T> all;
  for (const SettingRows& group : rows()) {
    all.insert(all.end(), (group.*part).begin(), (group.*part).end());
  }
  return all;
}

/// Copies the value of one setting.
struct Copy {
  const Config& from;
  Config& to;

  template <typename T>
  void operator()(const Member<T>& member) const {
    if (const T* const value = member.read(from)) {
      *member.write(to) = *value;
    }
  }
  template <typename T>
  void operator()(const Access<T>& access) const {
    if (const std::optional<T> value = access.read(from)) {
      access.write(to, *value);
    }
  }
};

}  // namespace

std::span<const Section> sections() {
  static const std::vector<Section> kSections = joined<Section>(&SettingRows::sections);
  return kSections;
}

std::span<const Setting> settings() {
  static const std::vector<Setting> kSettings = joined<Setting>(&SettingRows::settings);
  return kSettings;
}

std::optional<std::size_t> find_setting(std::string_view path) {
  const std::span<const Setting> all = settings();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Setting& setting) { return setting.path == path; });
  if (found == all.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - all.begin());
}

const Section* find_section(std::string_view name) {
  const std::span<const Section> all = sections();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Section& section) { return section.name == name; });
  return found == all.end() ? nullptr : &*found;
}

void copy_setting(const Setting& setting, const Config& from, Config& to) {
  std::visit(
      [&](const auto& kind) {
        if constexpr (requires { kind.member; }) {
          Copy{from, to}(kind.member);
        } else {
          Copy{from, to}(kind.access);
        }
      },
      setting.kind);
}

}  // namespace slamsensor::firmware
