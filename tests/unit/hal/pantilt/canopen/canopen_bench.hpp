#pragma once

#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"
#include "tests/support/scripted_can_link.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::tests {

/// A drive as a test plays it: an object dictionary of fixed size and just enough behaviour. Every frame it
/// sends is written out here, by hand.
struct PlayedNode {
  explicit PlayedNode(int number) : node(number) {
    objects = {{0x100000, 0x00020192},
               {0x100100, 0},
               {0x101801, 7},
               {0x101802, 9},
               {0x650200, 0x25},
               {0x607D01, -200000},
               {0x607D02, 200000},
               {0x607F00, 50000},
               {0x608100, 1000},
               {0x608300, 100000},
               {0x140001, 0x200 + node},
               {0x180001, 0x40000180 + node},
               {0x606400, 0},
               {0x606100, 1},
               {0x604100, 0x0240}};
  }

  void on_sdo(const hal::CanFrame& f, ScriptedCanLink& link) {
    const int key = f.data[2] << 16 | f.data[1] << 8 | f.data[3];
    const int at = key == refused ? 0x80 : f.data[0];
    if (at == 0x80) {
      link.deliver(can_frame(id(0x580), {0x80, f.data[1], f.data[2], f.data[3], 0, 0, 2, 6}));
    } else if (at == 0x40) {
      const bool known = objects.contains(key);
      const auto value = static_cast<std::uint32_t>(known ? objects[key] : 0x06020000);
      hal::CanFrame reply =
          can_frame(id(0x580), {known ? 0x43 : 0x80, f.data[1], f.data[2], f.data[3], 0, 0, 0, 0});
      for (std::size_t i = 0; i < 4; ++i) {
        reply.data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
      }
      link.deliver(reply);
    } else {
      writes.push_back(f);
      const auto value = static_cast<int>(hal::le_number(f, 4, 4));
      objects[key] = value;
      if (key == 0x604000) {
        control(value);
      }
      objects[0x606100] = key == 0x606000 ? value : objects[0x606100];
      link.deliver(can_frame(id(0x580), {0x60, f.data[1], f.data[2], f.data[3], 0, 0, 0, 0}));
    }
  }

  void control(int word) {
    const int old = objects[0x604100];
    switch (word & 0x8F) {
      case 0x06:
        objects[0x604100] = 0x0221;
        break;
      case 0x07:
        objects[0x604100] = 0x0223;
        break;
      case 0x0F:
        objects[0x604100] = 0x0627 | ((word & 0x10) << 8);
        break;
      case 0x80:
        objects[0x604100] = 0x0240;
        break;
      default:
        objects[0x604100] = old;
        break;
    }
  }

  [[nodiscard]] std::uint32_t id(int base) const { return static_cast<std::uint32_t>(base + node); }

  int node;
  int refused = -1;  // key of an object
  bool silent = false;
  std::map<int, int> objects;
  std::vector<hal::CanFrame> writes;
};

struct CanopenBench {
  explicit CanopenBench(const hal::CanopenConfig& settings = defaults())
      : driver(std::move(hal::CanopenPanTilt::create(settings, link).value())) {}

  static hal::CanopenConfig defaults() {
    hal::CanopenConfig config;
    config.homing = hal::CanopenHoming::Never;
    return config;
  }

  /// Milliseconds of both nodes and the driver.
  void run(int count) {
    for (int i = 0; i < count; ++i) {
      now += std::chrono::milliseconds(1);
      link.set_now(now);
      driver->step(now);
      for (const hal::CanFrame& frame : link.take_sent()) {
        sent.push_back(frame);
        play(pan, frame);
        play(tilt, frame);
      }
      if (now.count() % 100'000'000 == 0) {
        beat(pan);
        beat(tilt);
      }
    }
  }

  void beat(const PlayedNode& node) {
    if (!node.silent) {
      link.deliver(can_frame(node.id(0x700), {0x05}));
    }
  }

  void play(PlayedNode& node, const hal::CanFrame& frame) {
    if (node.silent) {
      return;
    }
    if (frame.id == node.id(0x600)) {
      node.on_sdo(frame, link);
    } else if (frame.id == 0x080) {
      const int s = node.objects[0x604100];
      const int p = node.objects[0x606400];
      link.deliver(can_frame(node.id(0x180),
                             {s & 255, s >> 8 & 255, p & 255, p >> 8 & 255, p >> 16 & 255, p >> 24 & 255}));
    } else if (frame.id == node.id(0x200)) {
      node.control(frame.data[0] | frame.data[1] << 8);
    }
  }

  [[nodiscard]] std::uint64_t counter(std::string_view name) const {
    const auto all = driver->counters();
    return std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.name == name; })->value;
  }
  [[nodiscard]] std::vector<hal::CanFrame> of(std::uint32_t id) const {
    std::vector<hal::CanFrame> some;
    std::copy_if(sent.begin(), sent.end(), std::back_inserter(some),
                 [&](const auto& f) { return f.id == id; });
    return some;
  }

  ScriptedCanLink link;
  PlayedNode pan{1};
  PlayedNode tilt{2};
  std::unique_ptr<hal::CanopenPanTilt> driver;
  hal::Stamp now = std::chrono::seconds(1);
  std::vector<hal::CanFrame> sent;
};

}  // namespace slamsensor::tests
