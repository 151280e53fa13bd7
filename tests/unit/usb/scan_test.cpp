#include "drivers/usb/scan.h"

#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>

#include "drivers/usb/choose.h"
#include "drivers/usb/node_access.h"
#include "drivers/usb/this_host.h"
#include "tests/unit/usb/device_tree.h"

namespace hapticd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const TreeUsb kFalconInTree{.path = "1-4", .vendor = "0403", .product = "cb48", .address = "4"};

TEST(Scan, FindsWhatADriverCouldHaveAndLeavesOutTheRest) {
  const DeviceTree tree;
  tree.add(kFalconInTree);
  tree.add(kFalconInTree, {.interface_class = "ff", .driver = "ftdi_sio"}, {});
  tree.add(TreeUsb{});
  tree.add(TreeUsb{}, {}, {{}});
  tree.add_hid(DeviceTree::directory(TreeUsb{}, 0), "hidraw0", vendor_descriptor(0xab));
  const std::string mouse(
      "\x05\x01\x09\x02\xa1\x01\x15\x00\x25\x01\x75\x08\x95\x01\x09\x30\x81\x02\xc0", 19);
  tree.add_hid("sys/devices/mouse", "hidraw1", mouse);
  const auto found = usb::scan(tree.roots());
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].kind, usb::Kind::falcon);
  EXPECT_EQ(found[0].about.path, "1-4");
  EXPECT_EQ(found[0].refused, "");
  EXPECT_EQ(found[1].kind, usb::Kind::hid_report);
  EXPECT_EQ(found[1].node, tree.at("dev/hidraw0"));
  EXPECT_EQ(found[1].usages, "ffab:0001");
  EXPECT_EQ(found[1].interface, 0);
  EXPECT_EQ(found[1].refused, "");
}

TEST(Scan, AnOpenFfboardIsKnownThoughItsDescriptorIsNone) {
  const DeviceTree tree;
  tree.add_hid(kUhid, "hidraw0", "\x01", "0003:00001209:0000FFB0");
  const auto found = usb::scan(tree.roots());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].kind, usb::Kind::openffboard);
  EXPECT_NE(found[0].refused, "");
}

TEST(Scan, SaysWhoHasADeviceAndWhatIsMissing) {
  const DeviceTree tree;
  tree.add(kFalconInTree);
  tree.add(kFalconInTree, {.interface_class = "ff", .driver = "usbfs"}, {});
  tree.add(TreeUsb{});
  tree.add(TreeUsb{}, {.driver = ""}, {{}});
  const auto found = usb::scan(tree.roots());
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_THAT(found[0].refused, HasSubstr("a program has it already"));
  EXPECT_THAT(found[1].refused, HasSubstr("no hidraw node"));
}

TEST(Scan, ANodeThatIsNotThereIsAReason) {
  const DeviceTree tree;
  tree.add(kFalconInTree);
  tree.add(kFalconInTree, {.interface_class = "ff", .driver = ""}, {});
  tree.remove("dev/bus/usb/001/004");
  ASSERT_THAT(usb::scan(tree.roots()), SizeIs(1));
  EXPECT_THAT(usb::scan(tree.roots())[0].refused, HasSubstr("has no node"));
}

TEST(Scan, AMachineWithoutUsbHasNoCandidates) {
  const DeviceTree tree;
  EXPECT_THAT(usb::scan(tree.roots()), IsEmpty());
}

/// Nodes that were opened in a directory and below, once it is watched.
class OpenedNodes {
 public:
  explicit OpenedNodes(const std::string& root) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
      if (entry.is_regular_file()) {
        EXPECT_GE(::inotify_add_watch(watch_, entry.path().c_str(), IN_OPEN), 0);
      }
  }
  OpenedNodes(const OpenedNodes&) = delete;
  OpenedNodes& operator=(const OpenedNodes&) = delete;
  ~OpenedNodes() { ::close(watch_); }
  std::size_t count() const {
    alignas(inotify_event) std::array<char, 4096> events{};
    const ssize_t got = ::read(watch_, events.data(), events.size());
    return got < 0 ? 0 : static_cast<std::size_t>(got) / sizeof(inotify_event);
  }

 private:
  int watch_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
};

/// A node that is opened, be it of another device, can stop what a loop is doing with it, or wake it.
TEST(Scan, NoNodeIsOpenedThatIsNotTheOneThatIsMeant) {
  const DeviceTree tree;
  tree.add(kFalconInTree);
  tree.add(kFalconInTree, {.interface_class = "ff", .driver = ""}, {{"81", "02"}, {"02", "02"}});
  tree.add(TreeUsb{});
  tree.add(TreeUsb{}, {}, {{}});
  tree.add_hid(DeviceTree::directory(TreeUsb{}, 0), "hidraw0", vendor_descriptor(0xab));
  const OpenedNodes opened(tree.at("dev"));
  EXPECT_THAT(usb::scan(tree.roots()), SizeIs(2));
  const auto host = usb::host_at(tree.roots());
  EXPECT_FALSE(host->open_bulk({.vendor = 0x0403, .product = 0x6001}, 0x81, 0x02));
  for (const auto transport : {usb::Transport::hidapi, usb::Transport::libusb})
    EXPECT_FALSE(host->open_hid({.vendor = 1, .product = 2, .transport = transport}));
  EXPECT_EQ(opened.count(), 0U);
  // The one that is meant is: this file is no device, but it was tried.
  EXPECT_FALSE(host->open_bulk({.vendor = 0x0403, .product = 0xcb48}, 0x81, 0x02));
  EXPECT_EQ(opened.count(), 1U);
}

TEST(NodeAccess, ARightThatIsMissingNamesOwnerModeAndTheRule) {
  const DeviceTree tree;
  tree.write("dev/hidraw0", "");
  const std::string node = tree.at("dev/hidraw0");
  ::chmod(node.c_str(), 0604);
  const Error error = usb::open_problem(node, EACCES);
  EXPECT_EQ(error.code, ExitCode::no_permission);
  EXPECT_THAT(error.text, AllOf(HasSubstr(node), HasSubstr(" 0604"), HasSubstr("60-hapticd.rules"),
                                HasSubstr("group hapticd"), HasSubstr("udevadm trigger")));
  EXPECT_EQ(usb::open_problem(node, EPERM).code, ExitCode::no_permission);
  EXPECT_EQ(usb::open_problem(node, ENOENT).code, ExitCode::unavailable);
}

/// In a process without root's rights.
TEST(NodeAccess, IsAskedForBothDirectionsAsTheProcessIs) {
  const DeviceTree tree;
  tree.write("dev/hidraw0", "");
  const std::string node = tree.at("dev/hidraw0");
  std::filesystem::permissions(tree.at(""), std::filesystem::perms::others_exec,
                               std::filesystem::perm_options::add);
  ::chmod(node.c_str(), 0444);
  const pid_t child = ::fork();
  if (child == 0) {
    const gid_t nobody = 65534;
    if (::getuid() == 0 &&
        (::setgroups(0, nullptr) != 0 || ::setgid(nobody) != 0 || ::setuid(nobody) != 0))
      ::_exit(3);
    const auto problem = usb::access_problem(node);
    ::_exit(problem && problem->code == ExitCode::no_permission ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  ::chmod(node.c_str(), 0666);
  EXPECT_FALSE(usb::access_problem(node));
}

/// Else a service that starts while its device is plugged in would end for good.
TEST(NodeAccess, ARightThatIsMissingToANewNodeIsWaitedForAndNothingElse) {
  const DeviceTree tree;
  tree.write("dev/hidraw0", "");
  const Error no_right = usb::open_problem(tree.at("dev/hidraw0"), EACCES);
  const auto fresh = usb::not_opened("Board", tree.at("dev/hidraw0"), no_right);
  EXPECT_TRUE(fresh.absent);
  EXPECT_THAT(fresh.error.text, AllOf(HasSubstr("Board: no right"), HasSubstr("60-hapticd.rules")));
  EXPECT_FALSE(usb::not_opened("Board", HAPTICD_SOURCE_DIR "/README.md", no_right).absent)
      << "that is older";
  const Error other = usb::open_problem(tree.at("dev/hidraw0"), EIO);
  EXPECT_FALSE(usb::not_opened("Board", tree.at("dev/hidraw0"), other).absent);
}

}  // namespace
}  // namespace hapticd::test
