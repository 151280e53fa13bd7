// USB/IP: the bytes, against the vectors, and the server as Linux' virtual host controller meets it.
#include "sim/usb/usbip.h"

#include "sim/usb/usbip_server.h"
#include "tests/unit/emulators/usb_echo.h"
#include "tests/unit/usb/vectors.h"

namespace hapticd::test::emulator {
namespace {

using sim::usb::End;
using sim::usb::Setup;
using sim::usb::UsbipServer;
using sim::usb::Wire;

template <std::size_t N>
std::array<std::uint8_t, N> exactly(const UsbBytes& bytes) {
  std::array<std::uint8_t, N> all{};
  EXPECT_EQ(bytes.size(), N);
  std::copy_n(bytes.begin(), std::min(bytes.size(), N), all.begin());
  return all;
}

// -- codec

void check_submit(const usb::Json& vector, const UsbBytes& message) {
  const auto request = usbip::decode_request(exactly<usbip::kHeaderBytes>(message));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->command, usbip::Command::submit);
  EXPECT_EQ(request->number, vector.at("seqnum").get<std::uint32_t>());
  const std::string name = vector.at("name");
  if (vector.contains("devid")) {
    EXPECT_EQ(request->device, vector.at("devid").get<std::uint32_t>());
  }
  if (vector.contains("dir")) {
    EXPECT_EQ(request->in, vector.at("dir").get<int>() == 1);
  }
  if (vector.contains("ep")) {
    EXPECT_EQ(request->endpoint, vector.at("ep").get<int>());
  }
  if (vector.contains("flags")) {
    EXPECT_EQ(request->flags, vector.at("flags").get<std::uint32_t>());
  }
  if (vector.contains("length")) {
    EXPECT_EQ(request->length, vector.at("length").get<std::uint32_t>());
  }
  if (vector.contains("setup")) {
    EXPECT_EQ(usb::hex(usbip::encode(request->setup)), vector.at("setup").get<std::string>());
  }
  if (name.find("interrupt IN ep1 64") != std::string::npos) {
    EXPECT_TRUE(request->in && request->endpoint == 1 && request->length == 64) << name;
    EXPECT_EQ(request->interval, 1U);
  }
  EXPECT_EQ(usb::hex(usbip::encode(*request)), vector.at("hex").get<std::string>());
}

void check_reply(const usb::Json& vector, const UsbBytes& message) {
  ASSERT_GE(message.size(), usbip::kHeaderBytes);
  const usbip::Reply made{
      .command = message[3] == 4 ? usbip::Command::unlinked : usbip::Command::submitted,
      .number = vector.at("seqnum").get<std::uint32_t>(),
      .status = vector.value("status", 0),
      .length = static_cast<std::uint32_t>(message.size() - usbip::kHeaderBytes)};
  const UsbBytes header(message.begin(), message.begin() + usbip::kHeaderBytes);
  EXPECT_EQ(usb::hex(usbip::encode(made)), usb::hex(header));
  EXPECT_EQ(usbip::decode_reply(exactly<usbip::kHeaderBytes>(header)), made);
}

void check_import(const usb::Json& vector, const UsbBytes& message) {
  const std::string name = vector.at("name");
  const std::string bus_id = name.substr(name.rfind(' ') + 1);
  EXPECT_EQ(usbip::decode_import(exactly<usbip::kImportBytes>(message)), bus_id);
  const auto made = usbip::encode_import(bus_id);
  ASSERT_TRUE(made);
  EXPECT_EQ(usb::hex(*made), usb::hex(message));
}

TEST(UsbipCodec, SaysAndReadsTheVectors) {
  usb::each_vector("usbip", [](const usb::Json& vector) {
    const std::string name = vector.at("name");
    const UsbBytes message = usb::bytes(vector, "hex");
    if (name.starts_with("CMD_SUBMIT"))
      check_submit(vector, message);
    else if (name.starts_with("RET_"))
      check_reply(vector, message);
    else if (name.starts_with("OP_REQ_IMPORT"))
      check_import(vector, message);
    else
      ADD_FAILURE() << "a vector of no kind that is known";
  });
}

TEST(UsbipCodec, AnUnlinkNamesTheOneThatIsTakenBack) {
  const usbip::Request unlink{
      .command = usbip::Command::unlink, .number = 9, .device = 0x10001, .unlinked = 0x01020304};
  const auto header = usbip::encode(unlink);
  EXPECT_EQ(usb::hex(header),
            "000000020000000900010001000000000000000001020304" + std::string(48, '0'));
  const auto read = usbip::decode_request(header);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->unlinked, 0x01020304U);
  EXPECT_EQ(read->payload_bytes(), 0U);
}

TEST(UsbipCodec, WhatNoHostSendsIsRefused) {
  const auto good = usbip::encode(usbip::Request{.number = 1, .length = 4, .interval = 1});
  const auto with = [&](std::size_t at, std::uint8_t value) {
    usbip::Header header = good;
    header[at] = value;
    return usbip::decode_request(header).has_value();
  };
  ASSERT_TRUE(usbip::decode_request(good));
  EXPECT_FALSE(with(3, 0));    // no command
  EXPECT_FALSE(with(3, 3));    // one of ours
  EXPECT_FALSE(with(0, 1));    // beyond 32 bits of sense
  EXPECT_FALSE(with(15, 2));   // direction
  EXPECT_FALSE(with(19, 16));  // endpoint
  EXPECT_FALSE(with(24, 1));   // 16 MiB
  EXPECT_FALSE(with(35, 8));   // isochronous packets
  usbip::Header none = good;
  std::fill_n(none.begin() + 32, 4, std::uint8_t{0});
  EXPECT_TRUE(usbip::decode_request(none));  // as Linux has it
}

TEST(UsbipCodec, AnImportWithoutAnEndIsRefused) {
  EXPECT_FALSE(usbip::encode_import(std::string(32, '1')));
  auto bytes = usbip::encode_import(std::string(31, '1'));
  ASSERT_TRUE(bytes);
  EXPECT_EQ(usbip::decode_import(*bytes), std::string(31, '1'));
  bytes->back() = '1';
  EXPECT_FALSE(usbip::decode_import(*bytes));
  bytes->back() = 0;
  (*bytes)[3] = 5;
  EXPECT_FALSE(usbip::decode_import(*bytes));
}

// -- server

class UsbipServed : public testing::Test {
 protected:
  /// Runs so many frames.
  bool run(int frames = 1) {
    bool goes_on = true;
    for (int i = 0; i < frames; ++i) goes_on = server_.advance(now_ns_ += kUsbFrame_ns);
    return goes_on;
  }
  /// What GET_DESCRIPTOR answers.
  UsbBytes descriptor(std::uint32_t number, std::uint16_t value, std::uint16_t length,
                      std::uint8_t request_type = 0x80) {
    host_.control(
        number,
        {.request_type = request_type, .request = 6, .value = value, .index = 0, .length = length});
    run();
    const auto got = host_.read(true);
    EXPECT_TRUE(got && got->reply.number == number && got->reply.status == 0);
    return got ? got->bytes : UsbBytes{};
  }
  void submit_in(std::uint32_t number, std::uint8_t endpoint, std::uint32_t length = 64) {
    host_.submit({.number = number, .in = true, .endpoint = endpoint, .length = length});
  }
  void submit_out(std::uint32_t number, std::uint8_t endpoint, const UsbBytes& bytes) {
    host_.submit({.number = number, .endpoint = endpoint}, bytes);
  }
  void expect_unlinked(std::uint32_t number, std::int32_t status) {
    const auto got = host_.read(false);
    ASSERT_TRUE(got);
    EXPECT_EQ(got->reply.command, usbip::Command::unlinked);
    EXPECT_EQ(got->reply.number, number);
    EXPECT_EQ(got->reply.status, status);
  }

  std::int64_t now_ns_ = 0;
  EchoUsb device_;
  Wire wire_{device_, {}};
  UsbipHost host_;
  UsbipServer server_{wire_, host_.device_fd(), UsbipHost::kDevice};
};

TEST_F(UsbipServed, EnumeratesAsLinuxDoesIt) {
  EXPECT_EQ(descriptor(1, 0x0100, 64), device_.device_descriptor());
  EXPECT_EQ(descriptor(2, 0x0100, 8), UsbBytes({18, 1, 0, 2, 0, 0, 0, 64}));
  EXPECT_EQ(descriptor(3, 0x0100, 18), device_.device_descriptor());
  const UsbBytes configuration = device_.configuration_descriptor();
  EXPECT_EQ(descriptor(4, 0x0200, 9), UsbBytes(configuration.begin(), configuration.begin() + 9));
  EXPECT_EQ(descriptor(5, 0x0200, static_cast<std::uint16_t>(configuration.size())), configuration);
  EXPECT_EQ(descriptor(6, 0x0300, 255), UsbBytes({4, 3, 9, 4}));
  EXPECT_EQ(descriptor(7, 0x0303, 255), UsbBytes({6, 3, 'E', 0, '1', 0}));
  host_.control(8, {.request_type = 0, .request = 9, .value = 1});
  run();
  EXPECT_EQ(host_.read(false)->reply, (usbip::Reply{.number = 8}));
  EXPECT_EQ(descriptor(9, 0x2200, 512, 0x81), device_.report_descriptor(0));
}

TEST_F(UsbipServed, AnInWaitsUntilThereIsSomething) {
  submit_in(1, 1);
  run(50);
  EXPECT_FALSE(host_.read(true));
  device_.to_say.push_back({2, {1, 2, 3}});
  run(2);
  const auto got = host_.read(true);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->reply, (usbip::Reply{.number = 1, .length = 3}));
  EXPECT_EQ(got->bytes, UsbBytes({1, 2, 3}));
}

TEST_F(UsbipServed, WhatComesLaterMayBeAnsweredFirst) {
  submit_in(1, 1);
  submit_in(2, 3);
  submit_out(3, 4, {5, 6});
  run(3);
  const auto out = host_.read(false), in = host_.read(true);
  ASSERT_TRUE(out && in);
  EXPECT_EQ(out->reply, (usbip::Reply{.number = 3, .length = 2}));
  EXPECT_EQ(in->reply.number, 2U);
  EXPECT_EQ(in->bytes, UsbBytes({5, 6}));
  EXPECT_EQ(server_.pending(), 1U);
}

TEST_F(UsbipServed, AnUnlinkTakesBackWhatWaits) {
  submit_in(1, 1);
  run();
  host_.unlink(2, 1);
  device_.to_say.push_back({2, {1}});
  now_ns_ += 1;
  ASSERT_TRUE(server_.advance(now_ns_));
  expect_unlinked(2, -104);
  run(5);
  EXPECT_FALSE(host_.read(true)) << "an answer after the unlink makes Linux drop the port";
  EXPECT_EQ(device_.to_say.size(), 1U);
}

TEST_F(UsbipServed, AnUnlinkOfWhatWasAnsweredSaysSo) {
  submit_out(1, 4, {5});
  run(2);
  ASSERT_TRUE(host_.read(false));
  host_.unlink(2, 1);
  run();
  expect_unlinked(2, 0);
  host_.unlink(3, 77);
  run();
  expect_unlinked(3, 0);
}

TEST_F(UsbipServed, AnUnlinkTakesBackAControlTransfer) {
  device_.busy = true;
  host_.control(1, {.request_type = 0xc0, .request = 1, .length = 8});
  run(3);
  EXPECT_FALSE(host_.read(true));
  host_.unlink(2, 1);
  run();
  expect_unlinked(2, -104);
  device_.busy = false;
  run(3);
  EXPECT_FALSE(host_.read(true));
}

TEST_F(UsbipServed, ABusyDeviceIsAskedAgain) {
  device_.busy = true;
  host_.control(1, {.request_type = 0xc0, .request = 1, .length = 8});
  host_.control(2, {.request_type = 0x40, .request = 2, .value = 3});
  run(4);
  EXPECT_FALSE(host_.read(true));
  EXPECT_LE(server_.next_ns(), now_ns_ + kUsbFrame_ns);
  device_.busy = false;
  run(2);
  const auto first = host_.read(true), second = host_.read(false);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->bytes, UsbBytes({9, 8, 7}));
  EXPECT_EQ(second->reply, (usbip::Reply{.number = 2}));
}

TEST_F(UsbipServed, DataOfARequestReachTheDeviceAndARefusalTheHost) {
  host_.control(1, {.request_type = 0x21, .request = 9, .value = 0x0201, .length = 2}, {4, 2});
  host_.control(2, {.request_type = 0x40, .request = 0x99});
  host_.control(3, {.request_type = 0x21, .request = 9, .length = 2}, {4, 2, 1});
  run();
  ASSERT_EQ(device_.asked.size(), 2U) << "more data than the request says";
  EXPECT_EQ(device_.asked[0].second, UsbBytes({4, 2}));
  EXPECT_EQ(host_.read(false)->reply, (usbip::Reply{.number = 1, .length = 2}));
  EXPECT_EQ(host_.read(false)->reply, (usbip::Reply{.number = 2, .status = -32}));
  EXPECT_EQ(host_.read(false)->reply, (usbip::Reply{.number = 3, .status = -32}));
}

TEST_F(UsbipServed, AnEndpointThatThereIsNoneIsRefused) {
  submit_in(1, 9);
  run();
  const auto got = host_.read(true);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->reply, (usbip::Reply{.number = 1, .status = -32}));
}

TEST_F(UsbipServed, UnpluggedAllThatWaitsIsToldThenTheConnectionEnds) {
  submit_in(1, 1);
  submit_in(2, 3);
  device_.busy = true;
  host_.control(3, {.request_type = 0xc0, .request = 1, .length = 8});
  run();
  wire_.unplug();
  EXPECT_FALSE(run());
  EXPECT_EQ(server_.over(), "unplugged");
  std::vector<std::uint32_t> told;
  while (const auto got = host_.read(true)) {
    EXPECT_EQ(got->reply.status, static_cast<std::int32_t>(End::gone));
    told.push_back(got->reply.number);
  }
  std::ranges::sort(told);
  EXPECT_EQ(told, std::vector<std::uint32_t>({1, 2, 3}));
  EXPECT_TRUE(host_.is_over());
  EXPECT_EQ(server_.next_ns(), sim::usb::kNever);
}

TEST_F(UsbipServed, AHostThatHangsUpLeavesNothingBehind) {
  submit_in(1, 1);
  run();
  host_.hang_up();
  EXPECT_FALSE(run());
  EXPECT_EQ(server_.pending(), 0U);
  device_.to_say.push_back({2, {1}});
  EXPECT_TRUE(wire_.advance(now_ns_ + 5 * kUsbFrame_ns).empty());
}

TEST_F(UsbipServed, AMessageMayComeByteByByte) {
  const auto header = usbip::encode(usbip::Request{
      .number = 5, .device = UsbipHost::kDevice, .endpoint = 4, .length = 3, .interval = 0});
  UsbBytes message(header.begin(), header.end());
  message.insert(message.end(), {7, 8, 9});
  for (const std::uint8_t byte : message) {
    EXPECT_TRUE(device_.got.empty());
    host_.write({&byte, 1});
    ASSERT_TRUE(server_.advance(now_ns_ += 1000));
  }
  run(2);
  ASSERT_EQ(device_.got.size(), 1U);
  EXPECT_EQ(device_.got[0].second, UsbBytes({7, 8, 9}));
}

TEST_F(UsbipServed, WhatIsNoRequestEndsTheConnection) {
  usbip::Header header{};
  header.fill(0xff);
  host_.write(header);
  EXPECT_FALSE(run());
  EXPECT_TRUE(host_.is_over());
  EXPECT_NE(server_.over(), "");
}

TEST_F(UsbipServed, AnotherDevicesRequestEndsTheConnection) {
  host_.write(usbip::encode(usbip::Request{.number = 1, .device = 7, .in = true}));
  EXPECT_FALSE(run());
}

TEST_F(UsbipServed, ANumberThatIsStillInUseEndsTheConnection) {
  submit_in(1, 1);
  submit_in(1, 3);
  EXPECT_FALSE(run());
}

TEST_F(UsbipServed, WhatTheHostDoesNotTakeYetIsKept) {
  const int small = 1;
  ASSERT_EQ(setsockopt(host_.device_fd(), SOL_SOCKET, SO_SNDBUF, &small, sizeof small), 0);
  constexpr std::uint32_t kMany = 400;
  for (std::uint32_t i = 1; i <= kMany; ++i) {
    host_.control(i, {.request_type = 0x80, .request = 6, .value = 0x0100, .length = 64});
    ASSERT_TRUE(run());
  }
  ASSERT_TRUE(server_.wants_to_write()) << "the socket took it all: nothing is shown";
  for (std::uint32_t i = 1; i <= kMany; ++i) {
    auto got = host_.read(true);
    if (!got) {
      ASSERT_TRUE(run());
      got = host_.read(true);
    }
    ASSERT_TRUE(got) << i;
    ASSERT_EQ(got->reply.number, i);
    ASSERT_EQ(got->bytes, device_.device_descriptor());
  }
  EXPECT_FALSE(server_.wants_to_write());
}

}  // namespace
}  // namespace hapticd::test::emulator
