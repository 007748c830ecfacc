#pragma once

#include "tools/emulator/canopen/emulated_drive.hpp"

#include <cstdio>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// One drive on a wire that notes every frame: "581 43 64 60 00 40 E2 01 00".
class DriveRig final : public FrameSink {
 public:
  explicit DriveRig(const DriveSettings& settings) : drive(settings, *this, 7) {}

  static DriveSettings ready() {
    DriveSettings settings;
    settings.begin = DeviceBegin::Ready;
    return settings;
  }

  void send(const hal::CanFrame& frame, Stamp at) override {
    frames.push_back(text_of(frame));
    times.push_back(at);
  }

  static std::string text_of(const hal::CanFrame& frame) {
    char part[8];
    std::snprintf(part, sizeof part, "%03X", frame.id);
    std::string text = part;
    for (const unsigned byte : frame.bytes()) {
      std::snprintf(part, sizeof part, " %02X", byte);
      text += part;
    }
    return text;
  }

  void host(const std::string& text) {
    hal::CanFrame frame;
    frame.id = static_cast<std::uint32_t>(std::stoul(text.substr(0, 3), nullptr, 16));
    for (std::size_t i = 4; i < text.size(); i += 3) {
      frame.data[frame.size++] = static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16));
    }
    drive.receive(frame, now);
  }

  void pass(Stamp time) {
    now += time;
    drive.advance(now);
  }

  /// What the drive sends within `time` of `text`; several frames are joined by " | ".
  std::string ask(const std::string& text, Stamp time = std::chrono::milliseconds(2)) {
    frames.clear();
    times.clear();
    host(text);
    pass(time);
    return heard();
  }

  [[nodiscard]] std::string heard() const {
    std::string all;
    for (const std::string& frame : frames) {
      all += (all.empty() ? "" : " | ") + frame;
    }
    return all;
  }

  Stamp now{};
  std::vector<std::string> frames;
  std::vector<Stamp> times;
  EmulatedDrive drive;
};

}  // namespace slamsensor::tools
