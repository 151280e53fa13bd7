// Virtual CAN interfaces that a test makes for itself, and what goes wrong with them. Needs root, in a guest.
#pragma once
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

namespace hapticd::test {

inline constexpr int kClassicMtu = 16, kFdMtu = 72;

inline void shell(const std::string& command) {
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}
inline std::string ip(const std::string& rest) {
  return "/usr/sbin/ip " + rest;
}

/// A new interface, switched on; removed with the object.
class Link {
 public:
  explicit Link(std::string name, int mtu = kClassicMtu) : name_(std::move(name)) {
    shell(ip("link add dev " + name_ + " type vcan"));
    there_ = true;
    shell(ip("link set " + name_ + " mtu " + std::to_string(mtu)));
    up();
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  ~Link() {
    if (there_) (void)std::system(ip("link delete " + name_).c_str());
  }

  const std::string& name() const { return name_; }
  void up() { shell(ip("link set " + name_ + " up")); }
  void down() { shell(ip("link set " + name_ + " down")); }
  void remove() {
    shell(ip("link delete " + name_));
    there_ = false;
  }
  void queue_length(int frames) {
    shell(ip("link set " + name_ + " txqueuelen " + std::to_string(frames)));
  }
  /// What tc's netem does to the frames on their way: "rate 100kbit limit 5".
  void netem(const std::string& what) {
    shell("/usr/sbin/tc qdisc replace dev " + name_ + " root netem " + what);
  }

 private:
  std::string name_;
  bool there_ = false;
};

}  // namespace hapticd::test
