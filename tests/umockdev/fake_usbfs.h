// The kernel's side of /dev/bus/usb and a device behind it, to the real libusb: what is submitted waits until a test lets it
// end. Reached through umockdev, which leads ioctls on the node here, in a thread of its own.
#pragma once
#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace hapticd::test {

using Bytes = std::vector<std::uint8_t>;

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};

struct ControlRequest {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0;
  Bytes data{};  ///< to the device
  std::size_t wanted = 0;
};

class FakeUsbfs {
 public:
  FakeUsbfs();
  ~FakeUsbfs();

  UMockdevTestbed* testbed() { return testbed_.get(); }
  std::string root() const;
  /// `texts`: as umockdev describes devices. The node is that of the device under test.
  void plug(const std::vector<std::string>& texts);

  // -- what the device does
  void say(const Bytes& packet, int status = 0);  ///< to the oldest IN transfer, or the next one
  void hold_out(bool hold);                       ///< OUT transfers stay under way
  void end_out(int status = 0);                   ///< the one that is held
  void unplug(int status);                        ///< of what is under way
  void hang() { hangs_ = true; }                  ///< control requests stay under way
  void ignore_cancelling() { ignores_cancelling_ = true; }
  void claimed_by_another() { claimed_ = true; }
  /// Answers control requests: bytes, or nothing for a stall. Without: all are taken, and give nothing.
  std::function<std::optional<Bytes>(const ControlRequest&)> control{};

  // -- what came of it
  std::size_t reads_under_way();
  std::vector<Bytes> sent();
  std::vector<ControlRequest> requests();
  std::vector<std::string>
  log();          ///< "claim 0", "release 0", "attach 0", "clear halt 81", "discard"
  void forget();  ///< what came so far

 private:
  static gboolean called(UMockdevIoctlBase*, UMockdevIoctlClient* client, FakeUsbfs* self);
  long handle(unsigned long request, void* argument, int& error);
  long submit(usbdevfs_urb* urb, int& error);
  void submit_control(usbdevfs_urb* urb);
  long cancel(usbdevfs_urb* urb, int& error);
  long reap(void** argument, int& error);
  long run_control(usbdevfs_ctrltransfer* transfer, int& error);
  void finish(usbdevfs_urb* urb, int status);
  void deliver(const Bytes& packet, int status);
  std::optional<Bytes> answer(const ControlRequest& request);

  std::unique_ptr<UMockdevTestbed, Unref> testbed_;
  std::unique_ptr<UMockdevIoctlBase, Unref> handler_;
  std::mutex mutex_;
  std::deque<usbdevfs_urb*> in_, out_, done_;
  std::deque<std::pair<Bytes, int>> said_;
  std::vector<Bytes> sent_;
  std::vector<ControlRequest> requests_;
  std::vector<std::string> log_;
  bool hold_out_ = false, unplugged_ = false, ignores_cancelling_ = false, claimed_ = false,
       hangs_ = false;
};

inline constexpr std::size_t kPacketBytes = 64;
inline constexpr const char* kNode = "/dev/bus/usb/001/002";

}  // namespace hapticd::test
