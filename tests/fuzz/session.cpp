#include "tests/fuzz/session.h"

#include <algorithm>
#include <deque>

namespace hapticd::fuzz {
namespace {

constexpr std::int64_t kStart_ns = 1'000'000'000'000;
constexpr std::int64_t kWire_ns = 100'000, kCollect_ns = 600'000, kCommand_ns = 700'000;
constexpr int kMostTicks = 50;

sim::can::Frame to_servo(const can::Frame& frame) {
  sim::can::Frame out{};
  out.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0) | (frame.remote ? CAN_RTR_FLAG : 0);
  out.len = frame.size;
  if (frame.fd) out.flags = CANFD_FDF | (frame.fast ? CANFD_BRS : 0);
  std::copy_n(frame.data.begin(), frame.payload().size(), out.data);
  return out;
}

can::Frame from_servo(const sim::can::Frame& in) {
  can::Frame frame{.id = sim::can::id_of(in),
                   .extended = sim::can::is_extended(in),
                   .fd = sim::can::is_fd(in),
                   .fast = (in.flags & CANFD_BRS) != 0,
                   .size = in.len};
  std::copy_n(in.data, in.len, frame.data.begin());
  return frame;
}

/// Between host and emulated drive, in virtual time.
class Link {
 public:
  explicit Link(sim::can::Drive& servo) : servo_(servo) {}

  std::int64_t now_ns() const { return now_ns_; }
  void wait_until(std::int64_t time_ns) {
    now_ns_ = std::max(now_ns_, time_ns);
    servo_.advance(now_ns_);
    for (const auto& sent : servo_.take_sent()) waiting_.push_back(sent);
  }
  void send(const can::Frame& frame) {
    must_be_legal(frame);
    wait_until(now_ns_);
    servo_.receive(to_servo(frame), now_ns_);
  }
  /// What has come by now.
  std::optional<can::Frame> take(std::int64_t& stamp_ns) {
    if (waiting_.empty() || waiting_.front().at_ns > now_ns_) return std::nullopt;
    stamp_ns = waiting_.front().at_ns;
    const can::Frame frame = from_servo(waiting_.front().frame);
    waiting_.pop_front();
    return frame;
  }
  /// When the next one may come.
  std::int64_t next_ns() const {
    return waiting_.empty() ? servo_.next_ns() : waiting_.front().at_ns;
  }

 private:
  sim::can::Drive& servo_;
  std::int64_t now_ns_ = kStart_ns;
  std::deque<sim::can::Drive::Outgoing> waiting_;
};

class SetUp final : public can::Conversation {
 public:
  SetUp(const Session& session, Link& link, bool disturbed)
      : session_(session), link_(link), disturbed_(disturbed) {}

  void send(const can::Frame& frame) override { link_.send(frame); }
  std::int64_t now_ns() override { return link_.now_ns(); }
  std::optional<can::Frame> next(double timeout_s) override {
    if (disturbed_ && !session_.input.empty() && (session_.input.byte() & 1) != 0) {
      link_.wait_until(link_.now_ns() + kWire_ns);
      return frame_of(session_.input,
                      [&](auto& frame, auto number) { session_.wire.own(frame, number); });
    }
    const std::int64_t until_ns = link_.now_ns() + std::llround(1e9 * timeout_s);
    std::int64_t stamp_ns = 0;
    for (;;) {
      link_.wait_until(link_.now_ns());
      if (const auto frame = link_.take(stamp_ns)) return frame;
      if (link_.now_ns() >= until_ns) return std::nullopt;
      link_.wait_until(std::min(until_ns, std::max(link_.next_ns(), link_.now_ns() + 1)));
    }
  }

 private:
  const Session& session_;
  Link& link_;
  bool disturbed_;
};

// The first byte of a tick.
constexpr std::uint8_t kSilent = 1 << 2, kForeign = 1 << 3, kFullQueue = 1 << 6, kEvent = 1 << 7;
enum class Wanted : std::uint8_t { on, on_again, as_it_is, off };

class Ticks {
 public:
  Ticks(const Session& session, Link& link)
      : session_(session), drive_(session.drive), input_(session.input), link_(link) {
    drive_.tell(text_);
  }

  void run_one() {
    constexpr std::int64_t kSteps_ns[] = {1'000'000, 1'000'000, 8'000'000, 60'000'000};
    const std::uint8_t what = input_.byte();
    start_ns_ += kSteps_ns[what & 3];
    link_.wait_until(start_ns_);
    drive_.begin_tick(start_ns_);
    send([&] { drive_.query(outbox_); }, true);
    if ((what & kEvent) != 0) event();
    link_.wait_until(start_ns_ + kCollect_ns);
    const bool foreign = (what & kForeign) != 0;
    const std::uint8_t spoil = foreign ? input_.byte() : 0;
    hear((what & kSilent) != 0, spoil);
    if (foreign && spoil == 0) {
      take(frame_of(input_, [&](auto& frame, auto number) { session_.wire.own(frame, number); }),
           link_.now_ns());
    }
    if (!wanted_) drive_.clear_failure();
    const auto wanted = static_cast<Wanted>((what >> 4) & 3);
    if (wanted <= Wanted::on_again) arm(true);
    link_.wait_until(start_ns_ + kCommand_ns);
    act((what & kFullQueue) == 0);
    if (wanted == Wanted::off) arm(false);
  }

 private:
  void check() const {
    must(!(drive_.armed() && drive_.failed()), "not armed while a failure stands");
    must(!(drive_.armed() && !wanted_), "not armed unless that is wanted");
    must(!(drive_.silent() && drive_.armed()), "not silent while it is armed");
    must(std::isfinite(drive_.counts()), "a position is a number");
    must(std::isfinite(drive_.carried_Nm()), "a torque is a number");
    must(!drive_.failed() || !text_.text().empty(), "a failure has words");
  }
  void arm(bool wanted) {
    wanted_ = wanted;
    drive_.set_armed(wanted);
    check();
  }
  void take(const can::Frame& frame, std::int64_t stamp_ns) {
    const can::Heard heard = drive_.take(frame, stamp_ns);
    if (heard == can::Heard::sample) must(drive_.stamp_ns() == stamp_ns, "a sample has its time");
    check();
  }
  /// `spoil`: not 0: which byte of each frame is another one than was sent, often one at an edge.
  void hear(bool lost, std::uint8_t spoil) {
    constexpr std::uint8_t kEdges[] = {0x80, 0xff};
    std::int64_t stamp_ns = 0;
    while (auto frame = link_.take(stamp_ns)) {
      if (spoil != 0) frame->data[spoil % 64] = spoil < 128 ? kEdges[spoil >> 6] : input_.byte();
      if (!lost) take(*frame, stamp_ns);
    }
  }
  template <class Fill>
  void send(const Fill& fill, bool arrives) {
    outbox_.clear();
    fill();
    must(outbox_.frames().size() < can::Socket::kMost, "a tick's frames fit");
    for (const can::Frame& frame : outbox_.frames()) {
      must_be_legal(frame);
      if (arrives) link_.send(frame);
    }
  }
  void act(bool arrives) {
    const double most_Nm = drive_.max_torque_Nm();
    const double torque_Nm = std::clamp(next_torque_Nm(), -most_Nm, most_Nm);
    const bool failed = drive_.failed();
    send([&] { drive_.act(torque_Nm, outbox_); }, arrives);
    double sent_Nm = 0;
    for (const can::Frame& frame : outbox_.frames())
      sent_Nm = session_.wire.torque_of(frame).value_or(sent_Nm);
    must(std::isfinite(sent_Nm), "a torque on the wire is a number");
    must(sent_Nm == 0 || (drive_.armed() && !failed), "no torque on the wire unless it is armed");
    must(sent_Nm == 0 || std::abs(sent_Nm - torque_Nm) <= session_.wire.tolerance_Nm(torque_Nm),
         "the torque on the wire is the wanted one");
    must(std::abs(sent_Nm - drive_.carried_Nm()) <= 1e-9 * std::abs(sent_Nm),
         "the torque that is told is the one on the wire");
    must(!failed || !outbox_.frames().empty(), "while a failure stands, the drive is told to stop");
    check();
    drive_.sent(arrives);
    check();
  }
  double next_torque_Nm() { return any_torque_ ? input_.number() : 0.5 * drive_.max_torque_Nm(); }
  void event() {
    const std::uint8_t which = input_.byte();
    switch (which & 7) {
      case 0:
        return session_.servo.fail(input_.take<std::uint16_t>(), link_.now_ns());
      case 1:
        return session_.servo.reset(link_.now_ns());
      case 2:
        return session_.servo.mute((which & 8) != 0);
      case 3:
        return session_.servo.move_to(1e-2 * input_.take<std::int16_t>(), input_.byte());
      case 4:
        any_torque_ = (which & 8) != 0;
        return;
      case 5:
        return arm((which & 8) != 0);
      default:  // what the loop does in a fault
        send([&] { drive_.stop_now(outbox_); }, true);
        return arm(false);
    }
  }

  const Session& session_;
  can::Drive& drive_;
  Input& input_;
  Link& link_;
  can::Outbox outbox_;
  drivers::FaultText text_;
  std::int64_t start_ns_ = link_.now_ns();
  bool wanted_ = false;
  bool any_torque_ = false;
};

}  // namespace

void run(const Session& session) {
  Link link(session.servo);
  SetUp set_up(session, link, (session.input.byte() & 3) == 3);
  const auto found = session.drive.connect(set_up);
  must(found ? !found->empty() : !found.error().text.empty(), "words, found or not");
  if (!found) return;
  Ticks ticks(session, link);
  for (int i = 0; i < kMostTicks && !session.input.empty(); ++i) ticks.run_one();
}

}  // namespace hapticd::fuzz
