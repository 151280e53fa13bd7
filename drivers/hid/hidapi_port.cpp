#include "drivers/hid/hidapi_port.h"

#include <dirent.h>
#include <hidapi/hidapi.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <mutex>
#include <utility>

#include "drivers/hid/superseding.h"
#include "drivers/usb/choose.h"
#include "drivers/usb/last_look.h"
#include "drivers/usb/node_access.h"
#include "drivers/usb/sysfs_file.h"

namespace hapticd::hid {
namespace {

using usb::Arrival;
using usb::Status;

constexpr std::int64_t kMillisecond_ns = 1'000'000;

struct CloseHid {
  void operator()(hid_device* device) const noexcept { hid_close(device); }
};
using HidPointer = std::unique_ptr<hid_device, CloseHid>;

/// Of a call that has failed.
Status status_of(int error) noexcept {
  if (error == ENODEV || error == ENXIO || error == ESHUTDOWN) return Status::gone;
  return error == EPIPE ? Status::stalled : Status::failed;
}

/// hidapi has one text for what fails without a device: opening is for one thread at a time.
HidPointer open_node(const std::string& node, std::string& error) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  if (hid_init() != 0) {
    error = "hidapi does not start";
    return {};
  }
  HidPointer device(hid_open_path(node.c_str()));
  if (device != nullptr) return device;
  const wchar_t* text = hid_error(nullptr);
  for (; text != nullptr && *text != 0; ++text)
    error += *text >= 0x20 && *text < 0x7f ? static_cast<char>(*text) : '?';
  return {};
}

class HidapiPort final : public usb::HidPort {
 public:
  HidapiPort(HidPointer device, const usb::HidNode& node, const ReportDescriptor& descriptor,
             usb::Waker& waker)
      : device_(std::move(device)),
        // hidapi does not say which descriptor it waits on, and its own wait nobody can end.
        descriptor_(descriptor_of(node.node)),
        report_descriptor_(node.report_descriptor),
        numbered_(descriptor.numbered),
        waker_(waker),
        // A byte more, so that a report that is too long is seen to be.
        read_(std::max(kMostReportBytes, longest_report(descriptor, ReportKind::input)) + 1),
        written_(std::max(kMostReportBytes, longest_report(descriptor, ReportKind::output)) + 1),
        queue_(read_.size(), superseding_of(descriptor)) {}

  Arrival receive(std::int64_t until_ns) override;
  Status send(std::span<const std::uint8_t> bytes) override;
  Status flush(std::int64_t) override { return gone_ ? Status::gone : Status::ok; }
  const usb::Outgoing& outgoing() const noexcept override { return outgoing_; }
  std::uint64_t skipped() const noexcept override { return queue_.skipped(); }
  Status set_feature(std::span<const std::uint8_t> report) override;
  std::size_t get_feature(std::span<std::uint8_t> report) override;
  const std::vector<std::uint8_t>& report_descriptor() const noexcept override {
    return report_descriptor_;
  }

 private:
  bool read(int timeout_ms) noexcept;
  void read_all() noexcept;
  void wait(std::int64_t until_ns) noexcept;

  HidPointer device_;
  int descriptor_;  ///< -1: not known
  std::vector<std::uint8_t> report_descriptor_;
  bool numbered_, gone_ = false;
  usb::Waker& waker_;
  std::vector<std::uint8_t> read_, written_;
  usb::ArrivalQueue queue_;
  usb::LastLook last_look_{};
  usb::Outgoing outgoing_{};
};

/// False: nothing came.
bool HidapiPort::read(int timeout_ms) noexcept {
  errno = 0;
  const int got = hid_read_timeout(device_.get(), read_.data(), read_.size(), timeout_ms);
  if (got < 0) gone_ = errno != EINTR;
  if (got <= 0) return false;
  queue_.push(std::span(read_).first(static_cast<std::size_t>(got)),
              last_look_.stamp(usb::monotonic_ns()));
  return true;
}

/// As many as the kernel keeps: a device that sends without end does not hold this thread.
void HidapiPort::read_all() noexcept {
  for (std::size_t i = 0; i < usb::ArrivalQueue::kMost && !gone_; ++i) {
    const std::int64_t before_ns = usb::monotonic_ns();
    if (read(0)) continue;
    last_look_.looked(before_ns);
    return;
  }
}

Arrival HidapiPort::receive(std::int64_t until_ns) {
  for (;;) {
    read_all();
    if (const Arrival arrival = queue_.take(); arrival.status == Status::ok) return arrival;
    if (gone_) return {.status = Status::gone};
    if (waker_.take() || usb::monotonic_ns() >= until_ns) return {};
    wait(until_ns);
  }
}

/// Without hidapi's descriptor the waker is looked at every millisecond.
void HidapiPort::wait(std::int64_t until_ns) noexcept {
  if (descriptor_ >= 0) {
    std::array both{pollfd{.fd = descriptor_, .events = POLLIN, .revents = 0}, waker_.descriptor()};
    usb::wait_for(both, std::min(until_ns, usb::monotonic_ns() + usb::LastLook::kEvery_ns));
    return;
  }
  if (until_ns - usb::monotonic_ns() >= kMillisecond_ns) {
    (void)read(1);
    return;
  }
  std::array waker{waker_.descriptor()};
  usb::wait_for(waker, until_ns);
}

Status HidapiPort::send(std::span<const std::uint8_t> bytes) {
  const std::size_t before = numbered_ ? 0 : 1;  // hidapi wants an id, 0 where there are none
  if (gone_) return Status::gone;
  if (bytes.empty() || bytes.size() + before > written_.size()) return Status::failed;
  std::ranges::copy(bytes, written_.begin() + static_cast<std::ptrdiff_t>(before));
  read_all();
  const std::int64_t begin_ns = usb::monotonic_ns();
  last_look_.away(begin_ns);
  errno = 0;
  const int wrote = hid_write(device_.get(), written_.data(), bytes.size() + before);
  const int error = errno;
  outgoing_.last_took_ns = usb::monotonic_ns() - begin_ns;
  outgoing_.worst_took_ns = std::max(outgoing_.worst_took_ns, outgoing_.last_took_ns);
  if (wrote < 0) {
    const Status status = status_of(error);
    gone_ = status == Status::gone;
    return status;
  }
  ++outgoing_.sent;
  return Status::ok;
}

Status HidapiPort::set_feature(std::span<const std::uint8_t> report) {
  errno = 0;
  const int sent = hid_send_feature_report(device_.get(), report.data(), report.size());
  return sent < 0 ? status_of(errno) : Status::ok;
}

std::size_t HidapiPort::get_feature(std::span<std::uint8_t> report) {
  return static_cast<std::size_t>(
      std::max(0, hid_get_feature_report(device_.get(), report.data(), report.size())));
}

/// Another may have been plugged in since sysfs was read, and have got the node's name; while it is open it keeps it.
bool is_still(const usb::HidNode& node, const usb::Roots& roots) {
  const auto now = usb::hid_node(roots, usb::sysfs::name_of(node.node));
  return now && now->about.vendor == node.about.vendor &&
         now->about.product == node.about.product && now->about.path == node.about.path &&
         now->report_descriptor == node.report_descriptor;
}

}  // namespace

int descriptor_of(const std::string& node) {
  struct stat wanted {};
  DIR* const all = ::opendir("/proc/self/fd");
  if (all == nullptr) return -1;
  int found = -1, fitting = 0;
  const bool is_device = ::stat(node.c_str(), &wanted) == 0 && S_ISCHR(wanted.st_mode);
  for (const dirent* entry = ::readdir(all); is_device && entry != nullptr;
       entry = ::readdir(all)) {
    struct stat status {};
    const int descriptor = std::atoi(entry->d_name);
    if (entry->d_name[0] == '.' || ::fstat(descriptor, &status) != 0) continue;
    if (!S_ISCHR(status.st_mode) || status.st_rdev != wanted.st_rdev) continue;
    found = descriptor;
    ++fitting;
  }
  ::closedir(all);
  return fitting == 1 ? found : -1;
}

namespace {

/// hidraw lets any number of programs write: of those that lock it first there is one.
bool lock(const std::string& node) {
  const int descriptor = descriptor_of(node);
  return descriptor < 0 || ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

usb::Opened<usb::Found<usb::HidPort>> open_hidapi(const usb::Selection& selection,
                                                  const usb::Roots& roots, usb::Waker& waker) {
  const auto node = usb::choose_hid_node(selection, roots);
  if (!node) return tl::unexpected(node.error());
  const std::string about = usb::words(node->about), what = about + ": ";
  const auto descriptor = parse_descriptor(node->report_descriptor);
  if (!descriptor) return usb::refused(ExitCode::unavailable, what + descriptor.error().text);
  if (const auto problem = usb::access_problem(node->node))
    return tl::unexpected(usb::not_opened(about, node->node, *problem));
  std::string error;
  HidPointer device = open_node(node->node, error);
  if (device == nullptr)
    return usb::refused(ExitCode::unavailable, what + node->node + " cannot be opened: " + error);
  if (!lock(node->node))
    return usb::refused(ExitCode::try_again,
                        what + node->node + " is in use by another program; stop that first");
  if (!is_still(*node, roots))
    return tl::unexpected(usb::NotOpened{
        .absent = true,
        .error = {what + "it was unplugged while it was opened", ExitCode::unavailable}});
  usb::Found<usb::HidPort> found{
      .port = std::make_unique<HidapiPort>(std::move(device), *node, *descriptor, waker),
      .product = node->about.name,
      .serial = node->about.serial,
      .path = node->about.path,
      .interval_s = node->interval_s};
  return found;
}

}  // namespace hapticd::hid
