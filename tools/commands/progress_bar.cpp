#include "tools/commands/progress_bar.hpp"

#include <cstdio>
#include <string>
#include <unistd.h>

namespace slamsensor::tools {

ProgressBar::ProgressBar(std::string_view what) : what_(what), visible_(isatty(STDERR_FILENO) == 1) {
}

ProgressBar::~ProgressBar() {
  if (visible_) {
    std::fputs("\r\033[K", stderr);
  }
}

void ProgressBar::update(std::size_t done, std::size_t total) {
  const std::size_t percent = total == 0 ? 100 : 100 * done / total;
  if (!visible_ || percent == percent_) {
    return;
  }
  percent_ = percent;
  std::string bar(percent * 40 / 100, '#');
  bar.resize(40, '.');
  std::fprintf(stderr, "\r%.*s [%s] %3zu %% (%zu of %zu)", static_cast<int>(what_.size()), what_.data(),
               bar.c_str(), percent, done, total);
}

}  // namespace slamsensor::tools
