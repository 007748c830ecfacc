// What must hold for every key, whatever it is: its bounds are allowed, what lies beyond is not, and what is
// in force is written such that it is read back as the very same value.

#include "firmware/config/list_config.hpp"
#include "firmware/config/load_config.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <type_traits>

namespace slamsensor::firmware {
namespace {

class EverySetting : public testing::Test {
 protected:
  [[nodiscard]] const Setting& setting() const { return settings()[index]; }

  /// The value in force after `value` was written; the mistake in its place.
  [[nodiscard]] std::string after(const std::string& value) const {
    LoadedConfig loaded;
    for (const ConfigError& error : apply_layer(loaded, std::string(setting().path) + " = " + value, "f")) {
      if (error.message.find("is missing; the keys of") == std::string::npos) {
        return error.text();
      }
    }
    return value_text(setting(), loaded.config).value_or("none");
  }

  void expect_refused(const std::string& value) const {
    EXPECT_THAT(after(value), testing::AllOf(testing::HasSubstr("f:1:"), testing::HasSubstr("; allowed: ")))
        << setting().path << " = " << value;
  }
  void expect_stable(const std::string& value) const {
    const std::string shown = after(value);
    EXPECT_THAT(shown, testing::Not(testing::HasSubstr("allowed"))) << setting().path << " = " << value;
    EXPECT_EQ(after(shown), shown) << setting().path << " = " << value;
  }

  void check_real(double min, double max) {
    expect_stable(real_text(min));
    expect_stable(real_text(max));
    expect_refused(real_text(std::nextafter(min, -1e300)));
    if (std::isfinite(max)) {
      expect_refused(real_text(std::nextafter(max, 1e300)));
      expect_refused("inf");
    }
    expect_refused("nan");
    expect_refused("-inf");
    std::uniform_real_distribution<double> any(min, std::min(max, 1e12));
    for (int i = 0; i < 20; ++i) {
      expect_stable(real_text(any(engine)));
    }
    expect_refused("\"" + real_text(min) + "\"");
    expect_refused("true");
  }

  void check(const RealSetting& s) { check_real(s.min, s.max); }
  void check(const DurationSetting& s) { check_real(s.min_s, s.max_s); }
  void check(const IntegerSetting& s) {
    std::uniform_int_distribution<std::int64_t> any(s.min, s.max);
    for (const std::int64_t value : {s.min, s.max, any(engine), any(engine)}) {
      if (s.only.empty() || std::find(s.only.begin(), s.only.end(), value) != s.only.end()) {
        expect_stable(std::to_string(value));
      } else {
        expect_refused(std::to_string(value));
      }
    }
    expect_refused(std::to_string(s.min - 1));
    expect_refused(std::to_string(s.max + 1));
    expect_refused(std::to_string(s.min) + ".0");
  }
  void check(const BooleanSetting&) {
    EXPECT_EQ(after("true"), "true");
    EXPECT_EQ(after("false"), "false");
    expect_refused("1");
  }
  void check_names(std::span<const std::string_view> names) {
    for (const std::string_view name : names) {
      EXPECT_EQ(after(quoted_text(name)), quoted_text(name)) << setting().path;
    }
    expect_refused("\"nonesuch\"");
    expect_refused("0");
  }
  void check(const ChoiceSetting& s) { check_names(s.names); }
  void check(const TextSetting& s) { check_names(s.names); }
  void check(const FreeTextSetting&) {
    expect_refused("5");
    expect_refused(quoted_text(std::string(300, 'x')));
    expect_refused(quoted_text("\xC3\xA9"));  // e with an accent: none of these, but a relative path
  }
  void check(const IntegerListSetting& s) {
    expect_stable("[" + std::to_string(s.min) + "]");
    expect_stable("[" + std::to_string(s.max) + ", " + std::to_string(s.min) + "]");
    expect_refused("[" + std::to_string(s.min - 1) + "]");
    expect_refused("[" + std::to_string(std::uint64_t{s.max} + 1) + "]");
    expect_refused("[]");
    expect_refused("[1.5]");
    expect_refused(std::to_string(s.min));
  }
  void check(const TextListSetting& s) {
    expect_refused("[5]");
    expect_refused("\"text\"");
    expect_refused("[[]]");
    std::string many;
    for (std::size_t i = 0; i <= s.items.max; ++i) {
      many += (many.empty() ? "[" : ", ") + std::string("\"x\"");
    }
    expect_refused(many + ']');
  }

  std::size_t index = 0;
  std::mt19937_64 engine{1};  // NOLINT: the same values every time
};

TEST_F(EverySetting, TakesWhatIsAllowedAndNothingElse) {
  for (index = 0; index < settings().size(); ++index) {
    engine.seed(index);
    SCOPED_TRACE("seed " + std::to_string(index) + ", " + std::string(setting().path));
    std::visit([this](const auto& kind) { check(kind); }, setting().kind);
    for (const char* value : {"[]", "{}", "2001-01-01", "[1, [2, [3]]]", "\"\\u0000\""}) {
      const std::string shown = after(value);  // no matter which, but one line and no more
      EXPECT_EQ(shown.find('\n'), std::string::npos);
      EXPECT_EQ(shown.find('\0'), std::string::npos);
    }
  }
}

TEST_F(EverySetting, IsCopiedAlone) {
  const Config defaults;
  for (index = 0; index < settings().size(); ++index) {
    SCOPED_TRACE(setting().path);
    const auto* const real = std::get_if<RealSetting>(&setting().kind);
    LoadedConfig other;
    if (real != nullptr) {
      static_cast<void>(apply_layer(other, std::string(setting().path) + " = " + real_text(real->min), "f"));
    }
    Config to;
    copy_setting(setting(), other.config, to);
    for (const Setting& each : settings()) {
      const bool is_touched = each.section() == setting().section() && setting().section() == "datum";
      const Config& expected = &each == &setting() ? other.config : defaults;
      if (&each == &setting() || !is_touched) {
        EXPECT_EQ(value_text(each, to), value_text(each, expected)) << each.path;
      }
    }
  }
}

}  // namespace
}  // namespace slamsensor::firmware
