#pragma once

#include "firmware/serving/epoch_sink.hpp"
#include "tests/unit/firmware/output/nmea_lines.hpp"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tests {

/// Keeps what it is given.
class EpochCollector final : public firmware::EpochSink {
 public:
  EpochCollector() { bytes_.reserve(1 << 20); }

  void step(hal::Stamp) noexcept override {}
  void send(std::span<const char> epoch, const firmware::OutputTime&) noexcept override {
    bytes_.append(epoch.data(), epoch.size());
    ++epochs_;
  }
  std::size_t poll_on(std::span<pollfd>) const noexcept override { return 0; }
  std::string_view problem() const noexcept override { return problem_; }
  std::span<const hal::Counter> counters() const noexcept override { return counters_; }

  void set_problem(std::string_view problem) { problem_ = problem; }
  [[nodiscard]] int epochs() const { return epochs_; }
  /// The fields of the sentences of `type` since the last call.
  std::vector<std::vector<std::string>> take(const std::string& type) {
    std::vector<std::vector<std::string>> result;
    for (std::size_t begin = 0; begin < bytes_.size();) {
      const std::size_t end = bytes_.find("\r\n", begin);
      const std::string line = bytes_.substr(begin, end - begin);
      if (line.find(type) == 1 || line.find(type) == 3) {
        result.push_back(fields(line));
      }
      begin = end + 2;
    }
    bytes_.clear();
    return result;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  int epochs_ = 0;
  std::string_view problem_;
  std::array<hal::Counter, 1> counters_{{{"collector_epochs", 7}}};
};

}  // namespace slamsensor::tests
