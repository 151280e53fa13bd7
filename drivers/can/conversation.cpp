#include "drivers/can/conversation.h"

#include <cmath>

namespace hapticd::can {

void SocketConversation::send(const Frame& frame) {
  waiting_ = {};  // answers to what was asked before
  (void)socket_.send({&frame, 1});
}

std::optional<Frame> SocketConversation::next(double timeout_s) {
  const std::int64_t until_ns = host_.now_ns() + std::llround(1e9 * timeout_s);
  for (;;) {
    if (waiting_.empty()) waiting_ = socket_.receive(host_.now_ns());
    if (!waiting_.empty()) {
      const Frame frame = waiting_.front().frame;
      waiting_ = waiting_.subspan(1);
      return frame;
    }
    if (host_.now_ns() >= until_ns || socket_.trouble() >= Trouble::down) return std::nullopt;
    host_.wait(socket_.descriptor(), until_ns);
  }
}

}  // namespace hapticd::can
