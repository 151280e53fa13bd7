// Which frames a socket hears, what they look like, and whose they are.
#include <gtest/gtest.h>

#include "tests/vm/kernel_can.h"
#include "tests/vm/links.h"

namespace hapticd::test {
namespace {

using can::Socket;
using std::vector;

TEST(CanFrames, OnlyWhatTheFiltersNameIsHeard) {
  const Link link("frames0");
  Socket socket = open_socket({.interface = link.name(),
                               .filters = {{.id = 3U << 5, .mask = 0x7e0},
                                           {.id = 0x12345, .mask = 0x1fffffff, .extended = true}}});
  RawSocket other(link.name());
  for (const std::uint32_t id : {0x05fU, 0x060U, 0x07fU, 0x080U, 0x345U}) other.send(id, {1});
  for (const std::uint32_t id : {0x060U, 0x12344U, 0x12345U}) other.send(id | CAN_EFF_FLAG, {2});
  other.send(0x061 | CAN_RTR_FLAG, {});
  other.send(0x12345 | CAN_EFF_FLAG | CAN_RTR_FLAG, {});
  other.report(CAN_ERR_TRX);                   // 0x10
  other.report(CAN_ERR_ACK | CAN_ERR_BUSOFF);  // 0x60 to a filter that forgets the flag

  const auto heard = hear(socket);
  EXPECT_EQ(ids_of(heard), (vector<std::uint32_t>{0x060, 0x07f, 0x12345}));
  for (const can::Received& one : heard) {
    EXPECT_EQ(one.frame.extended, one.frame.id == 0x12345);
    EXPECT_FALSE(one.frame.remote || one.frame.error || one.frame.fd);
  }
  EXPECT_EQ(socket.counters().received, 3U) << "error frames are trouble, not frames";
  EXPECT_EQ(socket.trouble(), can::Trouble::bus_off);
}

TEST(CanFrames, AFrameThatTwoFiltersNameIsHeardOnce) {
  const Link link("frames0");
  Socket socket = open_socket(
      {.interface = link.name(), .filters = {{.id = 0x80}, {.id = 0x80, .mask = 0x7f0}}});
  RawSocket(link.name()).send(0x80, {});
  EXPECT_EQ(hear(socket).size(), 1U);
}

TEST(CanFrames, WithoutFiltersNothingIsHeard) {
  const Link link("frames0");
  Socket socket = open_socket({.interface = link.name()});
  RawSocket(link.name()).send(0x123, {});
  EXPECT_TRUE(hear(socket).empty());
}

TEST(CanFrames, KindsOfFramesAreToldApartBySendingThem) {
  const Link link("frames0", kFdMtu);
  Socket socket = open_all(link.name(), true);
  RawSocket other(link.name(), true);
  canfd_frame heard{};

  can::Frame sent = frame(0x123, {1, 2, 3});
  socket.send({&sent, 1});
  EXPECT_EQ(other.read(heard), CAN_MTU);
  EXPECT_EQ(heard.can_id, 0x123U);
  EXPECT_EQ(heard.len, 3);

  sent = frame(0x069);
  sent.remote = true;
  sent.size = 8;  // asks for so many
  socket.send({&sent, 1});
  EXPECT_EQ(other.read(heard), CAN_MTU);
  EXPECT_EQ(heard.can_id, 0x069U | CAN_RTR_FLAG);
  EXPECT_EQ(heard.len, 8);

  sent = frame(0x8003, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  sent.extended = sent.fd = sent.fast = true;
  socket.send({&sent, 1});
  EXPECT_EQ(other.read(heard), CANFD_MTU);
  EXPECT_EQ(heard.can_id, 0x8003U | CAN_EFF_FLAG);
  EXPECT_EQ(heard.len, 12);
  EXPECT_EQ(heard.flags, CANFD_FDF | CANFD_BRS);
}

TEST(CanFrames, EveryLengthThatThereIsComesAcross) {
  const Link link("frames0", kFdMtu);
  Socket from = open_all(link.name(), true), to = open_all(link.name(), true);
  for (const bool fd : {false, true}) {
    for (std::size_t size = 0; size <= (fd ? 64U : 8U); ++size) {
      if (can::fd_length(size) != size) continue;
      can::Frame sent = frame(0x100);
      sent.fd = fd;
      sent.fast = fd && size > 8;
      sent.extended = size % 2 == 1;
      sent.size = static_cast<std::uint8_t>(size);
      for (std::size_t i = 0; i < size; ++i) sent.data[i] = static_cast<std::uint8_t>(0xff - i);
      ASSERT_EQ(from.send({&sent, 1}), 1U);
      const auto heard = hear(to, 5);
      ASSERT_EQ(heard.size(), 1U) << size;
      const can::Frame& got = heard[0].frame;
      EXPECT_EQ(got.fd, fd);
      EXPECT_EQ(got.fast, sent.fast);
      EXPECT_EQ(got.extended, sent.extended);
      EXPECT_TRUE(std::ranges::equal(got.payload(), sent.payload())) << size << (fd ? " FD" : "");
    }
  }
}

TEST(CanFrames, AClassicSocketHearsNoFdFrames) {
  const Link link("frames0", kFdMtu);
  Socket from = open_all(link.name(), true), to = open_all(link.name(), false);
  can::Frame sent[] = {frame(1), frame(2)};
  sent[0].fd = true;
  EXPECT_EQ(from.send(sent), 2U);
  EXPECT_EQ(ids_of(hear(to)), vector<std::uint32_t>{2});
}

TEST(CanFrames, OfOneselfAreNotHeardAndOfOtherProgramsAreLocal) {
  const Link link("frames0");
  Socket one = open_all(link.name()), two = open_all(link.name());
  const can::Frame sent[] = {frame(1), frame(2), frame(3)};
  EXPECT_EQ(one.send(sent), 3U);
  EXPECT_TRUE(hear(one).empty());
  const auto heard = hear(two);
  EXPECT_EQ(ids_of(heard), (vector<std::uint32_t>{1, 2, 3})) << "in the order of sending";
  for (const can::Received& received : heard) EXPECT_TRUE(received.local);
  EXPECT_EQ(one.counters().sent, 3U);
  EXPECT_EQ(two.counters().received, 3U);
}

TEST(CanFrames, ABatchThatIsLargerThanACallIsTakenInSeveral) {
  const Link link("frames0");
  Socket from = open_all(link.name()), to = open_all(link.name());
  vector<can::Frame> sent(40, frame(7));
  EXPECT_EQ(from.send(sent), Socket::kMost);
  EXPECT_EQ(from.counters().not_sent, 40 - Socket::kMost);
  EXPECT_EQ(from.send({sent.data(), 1}), 1U);
  EXPECT_EQ(to.receive(now_ns()).size(), Socket::kMost);
  EXPECT_TRUE(to.more());
  EXPECT_EQ(to.receive(now_ns()).size(), 1U);
  EXPECT_FALSE(to.more());
  EXPECT_TRUE(to.receive(now_ns()).empty());
}

}  // namespace
}  // namespace hapticd::test
