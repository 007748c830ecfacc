#pragma once

#include <cstddef>
#include <string_view>

namespace slamsensor::tools {

/// A progress bar on standard error; silent when that is no terminal. One thread.
class ProgressBar {
 public:
  explicit ProgressBar(std::string_view what);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  /// Clears the line.
  ~ProgressBar();

  /// Draws the bar when it has changed by a percent.
  void update(std::size_t done, std::size_t total);

 private:
  std::string_view what_;
  bool visible_;
  std::size_t percent_ = 101;
};

}  // namespace slamsensor::tools
