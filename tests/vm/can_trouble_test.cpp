// What the kernel says of an interface and its controller, and what a person is told of it.
#include <gtest/gtest.h>

#include "tests/vm/kernel_can.h"
#include "tests/vm/links.h"

namespace hapticd::test {
namespace {

using can::Socket;
using can::Trouble;

void expect_words(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << text;
}

/// Whether a frame gets from one to the other.
bool passes(Socket& from, Socket& to) {
  const can::Frame sent = frame(0x42, {1});
  return from.send({&sent, 1}) == 1 && ids_of(hear(to)) == std::vector<std::uint32_t>{0x42};
}

class CanTrouble : public testing::Test {
 protected:
  /// What has come makes of the socket.
  Trouble trouble() {
    EXPECT_TRUE(hear(socket, 5).empty()) << "an error frame is no frame";
    return socket.trouble();
  }

  Link link{"trouble0"};
  Socket socket = open_all(link.name());
  RawSocket controller{link.name()};
};

TEST_F(CanTrouble, BusOffStandsUntilTheControllerIsBack) {
  EXPECT_EQ(trouble(), Trouble::none);
  controller.report(CAN_ERR_BUSOFF);
  EXPECT_EQ(trouble(), Trouble::bus_off);
  socket.clear_trouble();
  EXPECT_EQ(trouble(), Trouble::bus_off);
  controller.report(CAN_ERR_RESTARTED);
  EXPECT_EQ(trouble(), Trouble::bus_off) << "the kernel's restart alone arms nothing";
  socket.clear_trouble();
  EXPECT_EQ(trouble(), Trouble::none);
}

TEST_F(CanTrouble, NobodyAcknowledges) {
  for (const std::uint32_t error : {CAN_ERR_ACK, CAN_ERR_TX_TIMEOUT}) {
    controller.report(error);
    EXPECT_EQ(trouble(), Trouble::unacknowledged);
    socket.clear_trouble();
    EXPECT_EQ(trouble(), Trouble::none);
  }
}

TEST_F(CanTrouble, AWarningIsNone) {
  controller.send(CAN_ERR_FLAG | CAN_ERR_CRTL, {0, CAN_ERR_CRTL_TX_PASSIVE, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(trouble(), Trouble::none);
}

TEST_F(CanTrouble, DownIsHeardAndTheSameSocketWorksOnceItIsUp) {
  Socket other = open_all(link.name());
  link.down();
  EXPECT_EQ(trouble(), Trouble::down);
  EXPECT_TRUE(socket.receive(now_ns()).empty());
  EXPECT_EQ(socket.trouble(), Trouble::down) << "later calls hear nothing bad any more";
  socket.clear_trouble();
  const can::Frame sent[] = {frame(1), frame(2)};
  EXPECT_EQ(socket.send(sent), 0U);
  EXPECT_EQ(socket.trouble(), Trouble::down) << "sending tells";
  EXPECT_EQ(socket.counters().not_sent, 2U);

  link.up();
  hear(other, 5);
  socket.clear_trouble();
  other.clear_trouble();
  EXPECT_TRUE(passes(socket, other));
  EXPECT_TRUE(passes(other, socket)) << "the filters are still there";
  EXPECT_EQ(socket.trouble(), Trouble::none);
  RawSocket(link.name()).report(CAN_ERR_BUSOFF);
  EXPECT_EQ(trouble(), Trouble::bus_off) << "and the error filter";
}

TEST_F(CanTrouble, WhoeverWaitsIsWokenWhenItGoesDown) {
  link.down();
  pollfd waiting{.fd = socket.descriptor(), .events = POLLIN, .revents = 0};
  EXPECT_EQ(::poll(&waiting, 1, 0), 1);
  EXPECT_EQ(trouble(), Trouble::down);
  EXPECT_EQ(::poll(&waiting, 1, 0), 0) << "once: else the loop would spin";
}

TEST_F(CanTrouble, RemovedIsGoneForEver) {
  Socket writer = open_all(link.name());
  link.remove();
  EXPECT_EQ(trouble(), Trouble::gone);
  const can::Frame sent = frame(1);
  EXPECT_EQ(writer.send({&sent, 1}), 0U);
  EXPECT_EQ(writer.send({&sent, 1}), 0U);
  EXPECT_EQ(writer.trouble(), Trouble::gone) << "sending alone tells";
  const Link again(link.name());
  socket.clear_trouble();
  EXPECT_EQ(socket.trouble(), Trouble::gone);
  EXPECT_EQ(socket.send({&sent, 1}), 0U);
  Socket new_one = open_all(again.name()), third = open_all(again.name());
  EXPECT_TRUE(passes(new_one, third));
}

TEST(CanOpen, SaysWhatTheMachineLacks) {
  expect_words(open_error({.interface = "open7"}), {"there is no interface open7", "ip link"});
  expect_words(open_error({.interface = "a_name_that_is_too_long"}), {"there is no interface"});
  expect_words(open_error({.interface = "lo"}), {"lo is no CAN interface"});
  Link link("open0");
  EXPECT_EQ(open_error({.interface = link.name()}), "");
  link.down();
  expect_words(open_error({.interface = link.name()}),
               {"open0 is switched off", "ip link set open0 up"});
}

TEST(CanOpen, FdIsAskedOfAnInterfaceThatHasIt) {
  const Link classic("open0"), fd("open1", kFdMtu);
  expect_words(open_error({.interface = classic.name(), .fd = true}),
               {"open0 carries classic frames only", "fd on"});
  EXPECT_EQ(open_error({.interface = fd.name(), .fd = true}), "");
  EXPECT_EQ(open_error({.interface = fd.name()}), "");
}

TEST(CanOpen, AQueueHoldsWhatATickSends) {
  Link link("open0");
  link.queue_length(4);
  EXPECT_EQ(open_error({.interface = link.name(), .frames_per_tick = 4}), "");
  expect_words(open_error({.interface = link.name(), .frames_per_tick = 5}),
               {"open0 queues 4 frames, expected 5 to 20", "ip link set open0 txqueuelen 10"});
}

}  // namespace
}  // namespace hapticd::test
