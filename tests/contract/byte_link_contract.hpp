#pragma once

#include "hal/transport/byte_link.hpp"
#include "tests/contract/rig.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace slamsensor::tests {

using Bytes = std::vector<std::uint8_t>;

/// A link that was not serviced yet, and what is at the far end of its line.
class ByteLinkRig : public Rig {
 public:
  [[nodiscard]] virtual hal::ByteLink& link() = 0;

  /// Puts `bytes`, at most 4096, on the line to the link.
  virtual void peer_write(std::span<const std::uint8_t> bytes) = 0;

  /// What has come from the link since the last call.
  [[nodiscard]] virtual Bytes peer_read() = 0;

  /// The far end goes to another line rate; nothing to do where rates do not matter.
  virtual void set_peer_baud(std::uint32_t baud) { static_cast<void>(baud); }

  /// Whether the hardware can do a rate.
  [[nodiscard]] virtual bool takes_baud(std::uint32_t baud) const { return baud > 0 && baud <= 4'000'000; }

  /// Whether the link keeps hal's promise to take no memory; a simulated one need not.
  [[nodiscard]] virtual bool promises_no_heap() const { return true; }

  /// Takes the device away, and brings it back. Both ends then have the line rate of the beginning, unless
  /// the link keeps another.
  virtual void cut() = 0;
  virtual void restore() = 0;
};

using ByteLinkRigMaker = RigMaker<ByteLinkRig>;

/// The contract of hal::ByteLink. To hold an implementation to it, instantiate this suite with a maker of its
/// rig: INSTANTIATE_TEST_SUITE_P(Name, ByteLinkContract, testing::Values(ByteLinkRigMaker{...}), RigName()).
class ByteLinkContract : public testing::TestWithParam<ByteLinkRigMaker> {
 protected:
  void SetUp() override;

  [[nodiscard]] hal::ByteLink& link() { return rig_->link(); }

  /// Time passes, and the link is serviced.
  void step(hal::Stamp time = std::chrono::milliseconds(1));

  /// Steps by a millisecond until `done`, at most 20,000 times; whether it was.
  [[nodiscard]] bool step_until(const std::function<bool()>& done);

  /// Services the link until it is up.
  void come_up();

  /// Waits for `count` bytes at either end; what came, which is less when they do not come.
  [[nodiscard]] Bytes read_bytes(std::size_t count);
  [[nodiscard]] Bytes peer_read_bytes(std::size_t count);

  /// Writes, waiting while the link is busy.
  void write_bytes(std::span<const std::uint8_t> bytes);

  /// Cuts the line and waits, reading as a driver does, until the link knows.
  void cut_and_notice();

  std::unique_ptr<ByteLinkRig> rig_;
};

}  // namespace slamsensor::tests
