// What CanSocket does beyond the contract, on a virtual interface of its own beside SLAMSENSOR_TEST_CAN:
// root.
#include "hal/transport/can_socket.hpp"

#include "tests/contract/can_frames.hpp"
#include "tests/contract/raw_can.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <linux/can/error.h>
#include <memory>
#include <vector>

namespace slamsensor::tests {
namespace {

using hal::CanFrame;
using hal::LinkStatus;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CanSocketTest : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("SLAMSENSOR_TEST_CAN") == nullptr) {
      GTEST_SKIP() << "SKIPPED, CanSocket was NOT tested on a bus: no CAN interface: run tests/system/run";
    }
    make_interface();
  }
  void TearDown() override {
    if (::if_nametoindex("slamtest0") != 0) {
      ip_link("del slamtest0");
    }
  }

  static void make_interface() {
    ip_link("add dev slamtest0 type vcan");
    ip_link("set slamtest0 up");
  }

  void open(std::vector<hal::CanFilter> filters = {}) {
    auto made = hal::CanSocket::create({"slamtest0", std::move(filters), {}});
    ASSERT_TRUE(made) << made.error().message;
    socket_ = std::move(*made);
    socket_->service(now_);
  }

  /// Services every 10 ms for `time`, and receives all that is there.
  std::vector<CanFrame> run(hal::Stamp time = std::chrono::milliseconds(10)) {
    std::vector<CanFrame> got;
    for (const hal::Stamp end = now_ + time; now_ < end;) {
      now_ += std::chrono::milliseconds(10);
      socket_->service(now_);
      for (hal::CanRead read = socket_->receive(); read.status == LinkStatus::Ok; read = socket_->receive()) {
        got.push_back(read.frame);
      }
    }
    return got;
  }

  std::uint64_t counted(std::string_view name) const {
    for (const hal::Counter& counter : socket_->counters()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    ADD_FAILURE() << "no counter " << name;
    return 0;
  }

  static can_frame raw(canid_t id, std::uint8_t first = 0, std::uint8_t second = 0) {
    can_frame frame{};
    frame.can_id = id;
    frame.len = 8;
    frame.data[0] = first;
    frame.data[1] = second;
    return frame;
  }

  hal::Stamp now_ = std::chrono::seconds(1);
  std::unique_ptr<hal::CanSocket> socket_;
};

TEST_F(CanSocketTest, LetsOnlyThePassOfItsFiltersIn) {
  open({{0x181, 0x7FF, false}, {0x580, 0x780, false}, {0x1000'0000, 0x1F00'0000, true}});
  RawCan peer("slamtest0");
  for (const canid_t id : {0x181U, 0x182U, 0x5FFU, 0x601U, 0x181U | CAN_EFF_FLAG, 0x10AB'CDEFU | CAN_EFF_FLAG,
                           0x1100'0000U | CAN_EFF_FLAG}) {
    can_frame frame = raw(id);
    frame.len = 0;
    peer.send(frame);
  }
  EXPECT_THAT(run(),
              ElementsAre(make_frame(0x181, {}), make_frame(0x5FF, {}), make_extended(0x10AB'CDEF, {})));
}

TEST_F(CanSocketTest, PassesOverRemoteAndFdFramesAndCountsThem) {
  open();
  RawCan peer("slamtest0");
  peer.send(raw(0x123 | CAN_RTR_FLAG));
  canfd_frame fd{};
  fd.can_id = 0x124;
  fd.len = 64;
  peer.send(fd);
  can_frame data = raw(0x125);
  data.len = 0;
  peer.send(data);
  EXPECT_THAT(run(), ElementsAre(make_frame(0x125, {})));
  EXPECT_EQ(counted("remote_ignored"), 1U);
  EXPECT_EQ(counted("fd_ignored"), 1U);
}

TEST_F(CanSocketTest, StampsComeFromTheKernel) {
  open();
  RawCan peer("slamtest0");
  for (int i = 0; i < 50; ++i) {
    peer.send(raw(0x100));
    EXPECT_EQ(run().size(), 1U);
  }
  EXPECT_EQ(counted("stamps_refused"), 0U);
}

TEST_F(CanSocketTest, CountsErrorFrames) {
  open();
  RawCan peer("slamtest0");
  peer.send(raw(CAN_ERR_FLAG | CAN_ERR_CRTL, 0, CAN_ERR_CRTL_TX_PASSIVE));
  peer.send(raw(CAN_ERR_FLAG | CAN_ERR_ACK));
  peer.send(raw(CAN_ERR_FLAG | CAN_ERR_TX_TIMEOUT));
  EXPECT_THAT(run(), IsEmpty());
  EXPECT_EQ(counted("error_passive"), 1U);
  EXPECT_EQ(counted("no_ack"), 1U);
  EXPECT_EQ(counted("tx_timeout"), 1U);
  EXPECT_TRUE(socket_->is_up());
}

TEST_F(CanSocketTest, IsDownAfterBusOffAndThenBack) {
  open();
  RawCan peer("slamtest0");
  ASSERT_EQ(socket_->epoch(), 1U);
  peer.send(raw(CAN_ERR_FLAG | CAN_ERR_BUSOFF));
  EXPECT_EQ(socket_->receive().status, LinkStatus::Down);
  EXPECT_FALSE(socket_->is_up());
  EXPECT_THAT(std::string(socket_->problem()), HasSubstr("bus-off"));
  EXPECT_EQ(counted("bus_off"), 1U);
  run(std::chrono::seconds(1));
  EXPECT_TRUE(socket_->is_up());
  EXPECT_EQ(socket_->epoch(), 2U);
  EXPECT_THAT(socket_->problem(), IsEmpty());
}

TEST_F(CanSocketTest, FindsAnInterfaceThatCameBackAsAnother) {
  open();
  const unsigned int before = ::if_nametoindex("slamtest0");
  ip_link("del slamtest0");
  run(std::chrono::seconds(3));
  EXPECT_FALSE(socket_->is_up());
  EXPECT_THAT(std::string(socket_->problem()), HasSubstr("slamtest0: look for it: No such device"));
  make_interface();
  ASSERT_NE(::if_nametoindex("slamtest0"), before);
  run(std::chrono::seconds(3));
  EXPECT_TRUE(socket_->is_up());
  EXPECT_EQ(socket_->epoch(), 2U);
  RawCan peer("slamtest0");
  peer.send(raw(0x42));
  EXPECT_EQ(run().size(), 1U);
}

TEST_F(CanSocketTest, NoticesThatTheInterfaceWentDownWithoutReceiving) {
  open();
  ip_link("set slamtest0 down");
  socket_->service(now_ + std::chrono::milliseconds(1));
  EXPECT_FALSE(socket_->is_up());
  EXPECT_EQ(counted("interface_lost"), 1U);
  run(std::chrono::seconds(1));
  EXPECT_THAT(std::string(socket_->problem()), HasSubstr("Network is down; set its bit rate"));
}

TEST_F(CanSocketTest, CountsWhatTheKernelThrewAway) {
  open();
  RawCan peer("slamtest0");
  for (int i = 0; i < 20'000; ++i) {
    peer.send(raw(0x100));
  }
  const std::size_t got = run().size();
  EXPECT_LT(got, 20'000U);
  peer.send(raw(0x101));
  EXPECT_EQ(run().size(), 1U);
  EXPECT_EQ(got + counted("frames_dropped"), 20'000U);
}

}  // namespace
}  // namespace slamsensor::tests
