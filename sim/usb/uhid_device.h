// A HID interface of an emulated device shown to Linux by /dev/uhid: hidraw without any USB in between. As the host of the
// Wire this keeps IN transfers waiting while the device is opened, so that it is asked in USB's rhythm all the same.
#pragma once
#include <linux/uhid.h>

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "control/core/result.h"
#include "sim/usb/control_queue.h"
#include "sim/usb/wire.h"

namespace hapticd::sim::usb {

/// /dev/uhid, non-blocking; the caller closes it. Errors: no module, no right.
Result<int> open_uhid();

/// Endpoints of an interface, without direction; 0: it has none.
struct HidEndpoints {
  std::uint8_t in = 0, out = 0;
  std::size_t in_bytes = 0;  ///< of a packet
};
HidEndpoints endpoints_of(std::span<const std::uint8_t> configuration, int interface);

/// Has a report descriptor report ids? Reports without are written to hidraw behind a 0 that is no part of them.
bool has_report_ids(std::span<const std::uint8_t> report_descriptor);

class UhidDevice {
 public:
  /// `fd`: of open_uhid(), or of a SOCK_SEQPACKET pair; is closed here, which for the kernel is unplugging.
  UhidDevice(Wire& wire, int fd, int interface);
  UhidDevice(const UhidDevice&) = delete;
  UhidDevice& operator=(const UhidDevice&) = delete;
  ~UhidDevice();

  /// Shows it while it is plugged in; takes what the kernel sent as sent now, runs the wire up to now, hands on what is
  /// done. False: the kernel has let go of it.
  bool advance(std::int64_t now_ns);
  std::int64_t next_ns() const;
  int fd() const { return fd_; }  ///< to wait on
  bool shown() const { return shown_; }
  bool opened() const { return opened_; }

 private:
  /// Of the kernel, that waits for its answer.
  struct Question {
    std::uint32_t kernel_id = 0;
    bool get = false;
  };

  void show();
  void hide();
  void hear(std::int64_t now_ns);
  void take(const uhid_event& event, std::int64_t now_ns);
  void output(const uhid_output_req& output, std::int64_t now_ns);
  void get_report(const uhid_get_report_req& request);
  void set_report(const uhid_set_report_req& request);
  void listen(std::int64_t now_ns);
  void stop_listening();
  void run(std::int64_t now_ns);
  void input(std::span<const std::uint8_t> report);
  void answer(const Question& question, const Wire::Done& done);
  void tell(const uhid_event& event, std::size_t bytes);

  Wire& wire_;
  int fd_, interface_;
  HidEndpoints endpoints_;
  bool numbered_;
  bool shown_ = false, opened_ = false, lost_ = false;
  bool halted_ =
      false;  ///< the IN endpoint stalled; the kernel has no word for it: silence until replugged
  std::uint64_t last_id_ = 0;
  std::set<std::uint64_t> inputs_;
  ControlQueue controls_;
  std::map<std::uint64_t, Question> questions_;
};

}  // namespace hapticd::sim::usb
