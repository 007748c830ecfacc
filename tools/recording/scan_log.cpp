#include "tools/recording/scan_log.hpp"

#include <utility>

namespace slamsensor::tools {

using firmware::ScanMessage;

ScanLog::ScanLog(const std::filesystem::path& path, std::size_t part)
    : name_(path.string()), file_(path, std::ios::binary), log_(file_), part_(part) {
}

std::optional<ScanMessage> ScanLog::next_message() {
  while (const auto event = log_.next()) {
    if (log_.part() != part_) {
      continue;
    }
    if (const auto message = firmware::decode_lcm<ScanMessage>(event->data)) {
      ++messages_;
      return message;
    }
  }
  return std::nullopt;
}

void ScanLog::add(const ScanMessage& message) {
  if (chunks_ == 0) {
    scan_ = {message.scan, firmware::scan_time_of(message), {}};
    begun_by_ = message.initialization;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    scan_.landmarks.push_back({{message.x_m[i], message.y_m[i]}, message.weight[i]});
  }
  ++chunks_;
}

void ScanLog::refuse_scan() {
  refused_.push_back(name_ + ": scan " + std::to_string(scan_.number) + ": message " +
                     std::to_string(chunks_) + " of it is missing");
  refused_scan_ = scan_.number;
  chunks_ = 0;
}

std::optional<LoggedScan> ScanLog::next() {
  while (const auto message = next_message()) {
    const bool goes_on = chunks_ > 0 && message->scan == scan_.number &&
                         message->initialization == begun_by_ && message->chunk == chunks_;
    if (chunks_ > 0 && !goes_on) {
      refuse_scan();
    }
    if (chunks_ == 0 && message->chunk != 0) {
      if (refused_scan_ != message->scan) {
        scan_.number = message->scan;
        refuse_scan();
      }
      continue;
    }
    add(*message);
    if (chunks_ == message->chunks) {
      chunks_ = 0;
      return std::move(scan_);
    }
  }
  if (chunks_ > 0) {
    refuse_scan();
  }
  return std::nullopt;
}

}  // namespace slamsensor::tools
