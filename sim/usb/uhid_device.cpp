#include "sim/usb/uhid_device.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

namespace hapticd::sim::usb {
namespace {

constexpr std::size_t kUhidReads = 2;  // IN transfers that wait at a time
constexpr std::uint8_t kClassToHost = 0xa1, kClassToDevice = 0x21;
constexpr std::uint8_t kGetHidReport = 0x01, kSetHidReport = 0x09;
constexpr std::uint8_t kInterfaceType = 4, kEndpointType = 5;

/// What HID calls the kinds that the kernel numbers otherwise.
std::uint16_t hid_kind(std::uint8_t kernel_kind) {
  switch (kernel_kind) {
    case UHID_INPUT_REPORT:
      return 1;
    case UHID_OUTPUT_REPORT:
      return 2;
    default:
      return 3;
  }
}

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

void put_text(__u8* to, std::size_t room, std::string_view text) {
  std::ranges::copy(text.substr(0, room - 1), to);
}

/// Without its 0 where there are no ids.
std::span<const std::uint8_t> report_of(const __u8* data, std::size_t size, bool numbered) {
  const std::span<const std::uint8_t> all(data, std::min<std::size_t>(size, UHID_DATA_MAX));
  return !numbered && !all.empty() && all[0] == 0 ? all.subspan(1) : all;
}

constexpr std::size_t kBeforeUnion = offsetof(uhid_event, u);

}  // namespace

Result<int> open_uhid() {
  const int fd = ::open("/dev/uhid", O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (fd >= 0) return fd;
  const std::string why = std::strerror(errno);
  if (errno == EACCES || errno == EPERM)
    return fail(ExitCode::no_permission, "an emulated HID device needs root: /dev/uhid: " + why);
  return fail(ExitCode::unavailable, "cannot show an emulated HID device: /dev/uhid: " + why +
                                         "; load the driver: modprobe uhid");
}

HidEndpoints endpoints_of(std::span<const std::uint8_t> configuration, int interface) {
  HidEndpoints found;
  bool inside = false;
  while (configuration.size() >= 2 && configuration[0] >= 2 &&
         configuration[0] <= configuration.size()) {
    const auto descriptor = configuration.first(configuration[0]);
    if (descriptor[1] == kInterfaceType && descriptor.size() >= 4)
      inside = descriptor[2] == interface && descriptor[3] == 0;
    if (inside && descriptor[1] == kEndpointType && descriptor.size() >= 7) {
      const bool in = (descriptor[2] & 0x80) != 0;
      (in ? found.in : found.out) = static_cast<std::uint8_t>(descriptor[2] & 0x0f);
      if (in) found.in_bytes = word(descriptor, 4) & 0x7ff;
    }
    configuration = configuration.subspan(descriptor.size());
  }
  return found;
}

bool has_report_ids(std::span<const std::uint8_t> report_descriptor) {
  constexpr std::uint8_t kReportId = 0x84, kWithoutSize = 0xfc, kLongItem = 0xfe;
  while (!report_descriptor.empty()) {
    const std::uint8_t prefix = report_descriptor[0];
    if ((prefix & kWithoutSize) == kReportId) return true;
    std::size_t size = 1 + ((prefix & 3) == 3 ? 4U : prefix & 3U);
    if (prefix == kLongItem && report_descriptor.size() >= 2)
      size = 3 + std::size_t{report_descriptor[1]};
    report_descriptor = report_descriptor.subspan(std::min(size, report_descriptor.size()));
  }
  return false;
}

UhidDevice::UhidDevice(Wire& wire, int fd, int interface)
    : wire_(wire),
      fd_(fd),
      interface_(interface),
      endpoints_(endpoints_of(wire.device().configuration_descriptor(), interface)),
      numbered_(has_report_ids(wire.device().report_descriptor(interface))) {}

UhidDevice::~UhidDevice() {
  hide();
  ::close(fd_);
}

bool UhidDevice::advance(std::int64_t now_ns) {
  if (wire_.plugged() && !shown_) show();
  run(now_ns);
  if (!wire_.plugged() && shown_) hide();
  hear(now_ns);
  run(now_ns);
  return !lost_;
}

std::int64_t UhidDevice::next_ns() const {
  return std::min(wire_.next_ns(), controls_.next_ns());
}

// -- to the kernel

void UhidDevice::tell(const uhid_event& event, std::size_t bytes) {
  if (::write(fd_, &event, kBeforeUnion + bytes) < 0 && errno != EAGAIN && errno != EINVAL)
    lost_ = true;
}

void UhidDevice::show() {
  const Device& device = wire_.device();
  const auto about = device.device_descriptor();
  const auto reports = device.report_descriptor(interface_);
  uhid_event event{};
  event.type = UHID_CREATE2;
  auto& told = event.u.create2;
  put_text(told.name, sizeof told.name, device.names().product);
  put_text(told.phys, sizeof told.phys, "emulated");
  put_text(told.uniq, sizeof told.uniq, device.names().serial);
  told.rd_size = static_cast<__u16>(std::min<std::size_t>(reports.size(), HID_MAX_DESCRIPTOR_SIZE));
  told.bus = BUS_USB;
  told.vendor = word(about, 8);
  told.product = word(about, 10);
  told.version = word(about, 12);
  std::copy_n(reports.begin(), told.rd_size, told.rd_data);
  tell(event, sizeof told);
  shown_ = true;
}

void UhidDevice::hide() {
  if (!shown_) return;
  stop_listening();
  for (const auto& [id, question] : questions_) controls_.cancel(id);
  questions_.clear();
  uhid_event event{};
  event.type = UHID_DESTROY;
  tell(event, 0);
  shown_ = opened_ = halted_ = false;
}

void UhidDevice::input(std::span<const std::uint8_t> report) {
  uhid_event event{};
  event.type = UHID_INPUT2;
  event.u.input2.size = static_cast<__u16>(std::min<std::size_t>(report.size(), UHID_DATA_MAX));
  std::copy_n(report.begin(), event.u.input2.size, event.u.input2.data);
  tell(event, sizeof event.u.input2.size + event.u.input2.size);
}

void UhidDevice::answer(const Question& question, const Wire::Done& done) {
  const auto error = static_cast<__u16>(done.end == End::ok ? 0 : EIO);
  uhid_event event{};
  if (!question.get) {
    event.type = UHID_SET_REPORT_REPLY;
    event.u.set_report_reply = {.id = question.kernel_id, .err = error};
    return tell(event, sizeof event.u.set_report_reply);
  }
  auto& reply = event.u.get_report_reply;
  event.type = UHID_GET_REPORT_REPLY;
  reply.id = question.kernel_id;
  reply.err = error;
  // As with usbhid, a report without id stands behind a 0.
  const std::size_t before = numbered_ ? 0 : 1;
  const std::size_t size = std::min<std::size_t>(done.bytes.size(), UHID_DATA_MAX - before);
  std::copy_n(done.bytes.begin(), size, reply.data + before);
  reply.size = static_cast<__u16>(size + before);
  tell(event, sizeof reply);
}

// -- from the kernel

void UhidDevice::hear(std::int64_t now_ns) {
  while (!lost_) {
    uhid_event event{};
    const ssize_t size = ::read(fd_, &event, sizeof event);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (size <= 0) lost_ = true;
    if (size >= static_cast<ssize_t>(kBeforeUnion)) take(event, now_ns);
  }
}

void UhidDevice::take(const uhid_event& event, std::int64_t now_ns) {
  if (!shown_) return;
  switch (event.type) {
    case UHID_OPEN:
      opened_ = true;
      return listen(now_ns);
    case UHID_CLOSE:
    case UHID_STOP:
      opened_ = false;
      return stop_listening();
    case UHID_OUTPUT:
      return output(event.u.output, now_ns);
    case UHID_GET_REPORT:
      return get_report(event.u.get_report);
    case UHID_SET_REPORT:
      return set_report(event.u.set_report);
    default:
      return;
  }
}

void UhidDevice::output(const uhid_output_req& output, std::int64_t now_ns) {
  const auto report = report_of(output.data, output.size, numbered_);
  if (output.rtype == UHID_OUTPUT_REPORT && endpoints_.out != 0)
    return wire_.submit_out(++last_id_, endpoints_.out, report, now_ns);
  const std::uint8_t number = numbered_ && !report.empty() ? report[0] : 0;
  const Setup setup{.request_type = kClassToDevice,
                    .request = kSetHidReport,
                    .value = static_cast<std::uint16_t>(hid_kind(output.rtype) << 8 | number),
                    .index = static_cast<std::uint16_t>(interface_),
                    .length = static_cast<std::uint16_t>(report.size())};
  controls_.add(++last_id_, setup, report);
}

void UhidDevice::get_report(const uhid_get_report_req& request) {
  const Setup setup{
      .request_type = kClassToHost,
      .request = kGetHidReport,
      .value = static_cast<std::uint16_t>(hid_kind(request.rtype) << 8 | request.rnum),
      .index = static_cast<std::uint16_t>(interface_),
      .length = UHID_DATA_MAX - 1};
  questions_[++last_id_] = {.kernel_id = request.id, .get = true};
  controls_.add(last_id_, setup, {});
}

void UhidDevice::set_report(const uhid_set_report_req& request) {
  const auto report = report_of(request.data, request.size, numbered_);
  const Setup setup{
      .request_type = kClassToDevice,
      .request = kSetHidReport,
      .value = static_cast<std::uint16_t>(hid_kind(request.rtype) << 8 | request.rnum),
      .index = static_cast<std::uint16_t>(interface_),
      .length = static_cast<std::uint16_t>(report.size())};
  questions_[++last_id_] = {.kernel_id = request.id, .get = false};
  controls_.add(last_id_, setup, report);
}

// -- transfers

void UhidDevice::listen(std::int64_t now_ns) {
  if (endpoints_.in == 0 || !wire_.plugged() || halted_) return;
  while (inputs_.size() < kUhidReads) {
    inputs_.insert(++last_id_);
    wire_.submit_in(last_id_, endpoints_.in, endpoints_.in_bytes, now_ns);
  }
}

void UhidDevice::stop_listening() {
  for (const std::uint64_t id : inputs_) (void)wire_.cancel(id);
  inputs_.clear();
}

void UhidDevice::run(std::int64_t now_ns) {
  for (const Wire::Done& done : wire_.advance(now_ns)) {
    if (inputs_.erase(done.id) == 0) continue;
    if (done.end == End::ok && opened_) input(done.bytes);
    halted_ = halted_ || done.end == End::stalled;
  }
  for (const Wire::Done& done : controls_.advance(wire_, now_ns)) {
    const auto found = questions_.find(done.id);
    if (found == questions_.end()) continue;
    answer(found->second, done);
    questions_.erase(found);
  }
  if (opened_) listen(now_ns);
}

}  // namespace hapticd::sim::usb
