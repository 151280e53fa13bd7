#include "drivers/can/drive.h"

namespace hapticd::can {

void Drive::set_armed(bool wanted) noexcept {
  if (wanted == arm_wanted_) return;
  arm_wanted_ = wanted;
  if (wanted) return start_arming();
  armed_ = silent_ = false;
  stops_left_ = kStops;
}

void Drive::act(double torque_Nm, Outbox& outbox) noexcept {
  carried_Nm_ = 0;
  if (failed_) return stop_now(outbox);
  if (arm_wanted_ && lost_)
    return fail(
        "the drive restarted: its position may count from elsewhere, and what it was told is gone",
        {}, "restart hapticd");
  if (arm_wanted_) return command(torque_Nm, outbox);
  stop(stops_left_ > 0, outbox);
}

void Drive::stop_now(Outbox& outbox) noexcept {
  carried_Nm_ = 0;
  armed_ = silent_ = false;
  stop(true, outbox);
}

void Drive::sent(bool all) noexcept {
  unsent_ticks_ = all ? 0 : unsent_ticks_ + 1;
  if (all && !arm_wanted_ && stops_left_ > 0) --stops_left_;
  if (all || !arm_wanted_) return;
  if (!armed_)
    fail("the bus did not take a frame that arms it", {}, "is the queue of the interface full?");
  else if (unsent_ticks_ > device_.most_unsent_ticks)
    fail("the bus takes no torque any more", {}, "is the queue of the interface full?");
}

FaultText& Drive::blame() noexcept {
  return text_->begin()
      .add(options_.axis)
      .add(" (node ")
      .add(options_.node)
      .add(" on ")
      .add(options_.interface)
      .add("): ");
}

void Drive::fail(std::string_view what, std::string_view word, std::string_view advice) noexcept {
  armed_ = silent_ = false;
  if (failed_) return;
  failed_ = true;
  FaultText& text = blame().add(what);
  if (!word.empty()) text.add(": ").add(word);
  if (!advice.empty()) text.add("; ").add(advice);
  text.publish();
}

std::string place_of(const DriveOptions& options) {
  return "node " + std::to_string(options.node) + " on " + options.interface;
}

}  // namespace hapticd::can
