// A HID interface shown by uhid: a pair of sockets stands in for the kernel.
#include "sim/usb/uhid_device.h"

#include <memory>
#include <string>

#include "tests/unit/emulators/usb_echo.h"

namespace hapticd::test::emulator {
namespace {

using sim::usb::UhidDevice;
using sim::usb::Wire;

constexpr UsbBytes::value_type kNumbered[] = {0x06, 0xab, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x85,
                                              0x01, 0x75, 0x08, 0x95, 0x08, 0x81, 0x02, 0xc0};

class Uhid : public testing::Test {
 protected:
  Uhid() {
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends_.data()) != 0)
      throw std::bad_alloc();
    shown_ = std::make_unique<UhidDevice>(wire_, ends_[1], 0);
  }
  ~Uhid() override {
    shown_.reset();
    if (ends_[0] >= 0) close(ends_[0]);
  }
  bool run(int frames = 1) {
    bool goes_on = true;
    for (int i = 0; i < frames; ++i) goes_on = shown_->advance(now_ns_ += kUsbFrame_ns);
    return goes_on;
  }
  void say(const uhid_event& event) const {
    ASSERT_EQ(send(ends_[0], &event, sizeof event, 0), static_cast<ssize_t>(sizeof event));
  }
  void say(std::uint32_t type) const {
    uhid_event event{};
    event.type = type;
    say(event);
  }
  std::optional<uhid_event> next() const {
    uhid_event event{};
    if (recv(ends_[0], &event, sizeof event, 0) <= 0) return std::nullopt;
    return event;
  }
  void open() {
    run();
    ASSERT_EQ(next()->type, UHID_CREATE2);
    say(UHID_START);
    say(UHID_OPEN);
    run();
  }
  void output(const UsbBytes& report, std::uint8_t kind = UHID_OUTPUT_REPORT) const {
    uhid_event event{};
    event.type = UHID_OUTPUT;
    std::ranges::copy(report, event.u.output.data);
    event.u.output.size = static_cast<std::uint16_t>(report.size());
    event.u.output.rtype = kind;
    say(event);
  }

  std::int64_t now_ns_ = 0;
  EchoUsb device_;
  Wire wire_{device_, {}};
  std::array<int, 2> ends_{};
  std::unique_ptr<UhidDevice> shown_;
};

TEST_F(Uhid, ShowsWhatTheDeviceSaysOfItself) {
  run();
  const auto created = next();
  ASSERT_TRUE(created && created->type == UHID_CREATE2);
  const uhid_create2_req& told = created->u.create2;
  EXPECT_STREQ(reinterpret_cast<const char*>(told.name), "echo");
  EXPECT_STREQ(reinterpret_cast<const char*>(told.uniq), "E1");
  EXPECT_EQ(told.bus, 3);  // USB
  EXPECT_EQ(told.vendor, 0x1234U);
  EXPECT_EQ(told.product, 0x5678U);
  EXPECT_EQ(UsbBytes(told.rd_data, told.rd_data + told.rd_size), device_.report_descriptor(0));
}

TEST_F(Uhid, TheDeviceIsAskedOnlyWhileItIsOpen) {
  device_.to_say = {{2, {1}}, {2, {2}}, {2, {3}}};
  run(5);
  ASSERT_EQ(next()->type, UHID_CREATE2);
  EXPECT_EQ(device_.to_say.size(), 3U);
  say(UHID_OPEN);
  run(3);
  const auto first = next(), second = next();
  ASSERT_TRUE(first && first->type == UHID_INPUT2 && second);
  EXPECT_EQ(first->u.input2.size, 1U);
  EXPECT_EQ(first->u.input2.data[0], 1);
  EXPECT_EQ(second->u.input2.data[0], 2);
  say(UHID_CLOSE);
  run();
  const std::size_t left = device_.to_say.size();
  device_.to_say.push_back({2, {4}});
  run(5);
  EXPECT_EQ(device_.to_say.size(), left + 1);
}

TEST_F(Uhid, OneReportAFrame) {
  open();
  for (std::uint8_t i = 0; i < 10; ++i) device_.to_say.push_back({2, {i}});
  for (std::size_t left = 10; left-- > 0; run()) {
    EXPECT_EQ(device_.to_say.size(), left + 1);
  }
}

TEST_F(Uhid, TheZeroOfAReportWithoutIdIsNoPartOfIt) {
  open();
  output({0, 5, 6});
  run(2);
  ASSERT_EQ(device_.got.size(), 1U);
  EXPECT_EQ(device_.got[0], (std::pair<std::uint8_t, UsbBytes>(2, {5, 6})));
}

TEST_F(Uhid, AnOutputOfAFeatureGoesByAControlTransfer) {
  open();
  output({0, 5, 6}, UHID_FEATURE_REPORT);
  run();
  ASSERT_EQ(device_.asked.size(), 1U);
  EXPECT_EQ(device_.asked[0].first.request, 9);
  EXPECT_EQ(device_.asked[0].first.value, 0x0300);
  EXPECT_EQ(device_.asked[0].second, UsbBytes({5, 6}));
}

TEST_F(Uhid, GetReportAnswersBehindTheZeroThatUsbhidPutsThere) {
  open();
  uhid_event event{};
  event.type = UHID_GET_REPORT;
  event.u.get_report = {.id = 77, .rnum = 0, .rtype = UHID_FEATURE_REPORT};
  say(event);
  run();
  const auto answer = next();
  ASSERT_TRUE(answer && answer->type == UHID_GET_REPORT_REPLY);
  EXPECT_EQ(answer->u.get_report_reply.id, 77U);
  EXPECT_EQ(answer->u.get_report_reply.err, 0);
  ASSERT_EQ(answer->u.get_report_reply.size, 4);
  const std::uint8_t* data = answer->u.get_report_reply.data;
  EXPECT_EQ(UsbBytes(data, data + 4), UsbBytes({0, 9, 8, 7}));
  EXPECT_EQ(device_.asked[0].first.value, 0x0300);
  EXPECT_EQ(device_.asked[0].first.request_type, 0xa1);
}

TEST_F(Uhid, SetReportIsAnsweredOnceTheDeviceHasIt) {
  open();
  device_.busy = true;
  uhid_event event{};
  event.type = UHID_SET_REPORT;
  event.u.set_report = {
      .id = 78, .rnum = 0, .rtype = UHID_OUTPUT_REPORT, .size = 3, .data = {0, 4, 2}};
  say(event);
  run(3);
  EXPECT_FALSE(next());
  device_.busy = false;
  run(2);
  const auto answer = next();
  ASSERT_TRUE(answer && answer->type == UHID_SET_REPORT_REPLY);
  EXPECT_EQ(answer->u.set_report_reply.id, 78U);
  EXPECT_EQ(answer->u.set_report_reply.err, 0);
  EXPECT_EQ(device_.asked.back().second, UsbBytes({4, 2}));
  EXPECT_EQ(device_.asked.back().first.value, 0x0200);
}

TEST_F(Uhid, UnpluggedItIsTakenAwayAndPluggedInShownAnew) {
  open();
  wire_.unplug();
  ASSERT_TRUE(run());
  EXPECT_EQ(next()->type, static_cast<std::uint32_t>(UHID_DESTROY));
  run(5);
  EXPECT_FALSE(next());
  wire_.plug(true, now_ns_);
  run();
  EXPECT_EQ(next()->type, static_cast<std::uint32_t>(UHID_CREATE2));
  EXPECT_FALSE(shown_->opened());
}

TEST_F(Uhid, ItsEndIsAnUnplugging) {
  open();
  shown_.reset();
  EXPECT_EQ(next()->type, static_cast<std::uint32_t>(UHID_DESTROY));
}

TEST_F(Uhid, AKernelThatIsGoneEndsIt) {
  open();
  close(ends_[0]);
  ends_[0] = -1;
  EXPECT_FALSE(run());
}

TEST(UhidDescriptors, EndpointsAreThoseOfTheInterface) {
  const UsbBytes configuration = EchoUsb().configuration_descriptor();
  const auto hid = sim::usb::endpoints_of(configuration, 0);
  EXPECT_EQ(hid.in, 1);
  EXPECT_EQ(hid.out, 2);
  EXPECT_EQ(hid.in_bytes, 64U);
  const auto bulk = sim::usb::endpoints_of(configuration, 1);
  EXPECT_EQ(bulk.in, 3);
  EXPECT_EQ(bulk.out, 4);
  EXPECT_EQ(sim::usb::endpoints_of(configuration, 2).in, 0);
  for (std::size_t size = 0; size < configuration.size(); ++size)
    (void)sim::usb::endpoints_of(std::span(configuration).first(size), 1);
}

TEST(UhidDescriptors, AReportIdIsAnItemAndNoDatum) {
  EXPECT_TRUE(sim::usb::has_report_ids(kNumbered));
  EXPECT_FALSE(sim::usb::has_report_ids(EchoUsb().report_descriptor(0)));
  const UsbBytes datum{0x26, 0x85, 0x01};  // logical maximum 0x185
  EXPECT_FALSE(sim::usb::has_report_ids(datum));
  const UsbBytes long_item{0xfe, 2, 0x10, 0x85, 0x01, 0x75, 0x08};
  EXPECT_FALSE(sim::usb::has_report_ids(long_item));
  const UsbBytes cut{0x27, 0x85};
  EXPECT_FALSE(sim::usb::has_report_ids(cut));
}

}  // namespace
}  // namespace hapticd::test::emulator
