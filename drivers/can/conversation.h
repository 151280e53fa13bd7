// Questions and answers on one bus before the loop runs. May wait.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/can/frame.h"
#include "drivers/can/host.h"
#include "drivers/can/socket.h"

namespace hapticd::can {

class Conversation {
 public:
  virtual ~Conversation() = default;
  virtual void send(const Frame& frame) = 0;
  /// The next frame that comes within `timeout_s`; none: it is over.
  virtual std::optional<Frame> next(double timeout_s) = 0;
  virtual std::int64_t now_ns() = 0;
};

class SocketConversation final : public Conversation {
 public:
  SocketConversation(Socket& socket, Host& host) : socket_(socket), host_(host) {}

  void send(const Frame& frame) override;
  std::optional<Frame> next(double timeout_s) override;
  std::int64_t now_ns() override { return host_.now_ns(); }

 private:
  Socket& socket_;
  Host& host_;
  std::span<const Received> waiting_{};
};

}  // namespace hapticd::can
