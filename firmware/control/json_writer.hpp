#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Writes one JSON value (RFC 8259) in one line, members in the order of the calls. Whoever calls keeps
/// beginnings and ends in pairs and gives each member of an object its key.
class JsonWriter {
 public:
  JsonWriter& begin_object() { return open('{'); }
  JsonWriter& end_object() { return close('}'); }
  JsonWriter& begin_array() { return open('['); }
  JsonWriter& end_array() { return close(']'); }

  JsonWriter& key(std::string_view name);

  /// Bytes that are no UTF-8 are kept as they are.
  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  /// The shortest decimal that reads back as `number`; null when it is not finite.
  JsonWriter& value(double number);
  JsonWriter& value(bool truth) { return raw(truth ? "true" : "false"); }
  template <std::unsigned_integral T>
  JsonWriter& value(T number) {
    return raw(std::to_string(number));
  }
  JsonWriter& value(std::int64_t number) { return raw(std::to_string(number)); }
  JsonWriter& null() { return raw("null"); }

  template <typename T>
  JsonWriter& member(std::string_view name, const T& content) {
    return key(name).value(content);
  }

  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  JsonWriter& raw(std::string_view text);
  void quote(std::string_view text);
  void separate();

  std::string text_;
  bool is_first_ = true;  // of its object or array, or right behind its key
};

}  // namespace slamsensor::firmware
