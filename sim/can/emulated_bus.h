// A CAN bus with drives at one end and a descriptor at the other: what the host writes there as
// struct can_frame / canfd_frame reaches the drives, what they say can be read there. Either a
// SocketCAN raw socket with CAN_RAW_FD_FRAMES or one end of a socketpair(AF_UNIX, SOCK_SEQPACKET).
//
// Between descriptor and bus lies the host's adapter: delay, jitter (order is kept) and loss act
// there, in both directions. One frame is on the bus at a time; of those waiting the lowest id goes
// first. The host's own frames wait behind each other, as in its queue.
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "sim/can/drive.h"

namespace hapticd::sim::can {

struct WireOptions {
  double nominal_Hz = 1e6;
  double data_Hz = 5e6;
  double loss = 0;       ///< share of frames that are lost, in each direction
  double duplicate = 0;  ///< share of frames that arrive twice, in each direction
  double delay_s = 0;    ///< of the adapter, in each direction
  double jitter_s = 0;   ///< and up to that much more
  std::uint64_t seed = 1;
};

class EmulatedBus {
 public:
  /// `fd` is not owned, and used without blocking.
  EmulatedBus(int fd, const WireOptions& options);

  void add(Drive& drive) { drives_.push_back(&drive); }

  /// Takes what the host sent (as if sent at `now_ns`, each frame occupying the bus in turn), runs
  /// the drives' timers up to now in the order of time, gives to the host what is due by now.
  /// Frames that the host cannot take are dropped and counted.
  void advance(std::int64_t now_ns);
  /// When advance() next has something to do without news from the host; kNever: nothing.
  std::int64_t next_ns() const;

  /// May be changed while running, but for the seed.
  WireOptions& options() { return options_; }
  /// Of those to the host.
  void lose_next(int frames) { to_lose_ += frames; }
  /// Swaps the next two frames to the host.
  void reorder_next() { reorder_ = true; }
  /// To the host only, from nowhere: foreign master, malformed, error frame. It does not occupy the
  /// bus and nothing delays or loses it.
  void inject(const Frame& frame, std::int64_t at_ns) { injected_.push_back({at_ns, frame}); }

  /// From the host, that went onto the bus.
  std::uint64_t received() const { return received_; }
  /// Given to the host.
  std::uint64_t sent() const { return sent_; }
  /// Of those to the host, because it could not take them.
  std::uint64_t dropped() const { return dropped_; }
  /// From the host, because no controller could send them: wrong size of the read, of the data, or
  /// an FD length that no DLC says.
  std::uint64_t refused() const { return refused_; }

 private:
  struct Timed {
    std::int64_t at_ns = 0;
    Frame frame{};
  };
  struct Waiting {
    std::int64_t at_ns = 0;
    Frame frame{};
    const Drive* from = nullptr;  ///< nullptr: the host
  };

  void hear_host(std::int64_t now_ns);
  void accept(const Frame& frame, std::int64_t now_ns);
  void run_until(std::int64_t now_ns);
  void step(std::int64_t at_ns);
  void advance_drives(std::int64_t at_ns);
  void collect_sent();
  std::int64_t next_start_ns() const;
  void start_frame(std::int64_t at_ns);
  void end_frame(std::int64_t at_ns);
  void to_drives(const Waiting& sent, std::int64_t at_ns);
  void to_host(const Frame& frame, std::int64_t at_ns);
  void queue_to_host(const Frame& frame, std::int64_t at_ns);
  void give_due(std::int64_t at_ns);
  void give(const Frame& frame);
  double uniform();
  bool happens(double share) { return share > 0 && uniform() < share; }
  std::int64_t adapter_ns();

  int fd_;
  WireOptions options_;
  std::mt19937_64 engine_;
  std::vector<Drive*> drives_;
  std::int64_t time_ns_ = INT64_MIN;  ///< nothing happens before it any more
  std::deque<Waiting> host_;          ///< in the host's queue
  std::vector<Waiting> waiting_;      ///< of the drives
  std::optional<Waiting> on_bus_;     ///< at_ns: when it ends
  std::deque<Timed> due_;             ///< on the way to the host
  std::vector<Timed> injected_;
  std::optional<Frame> held_back_;  ///< until the next one has gone
  bool reorder_ = false;
  int to_lose_ = 0;
  std::uint64_t received_ = 0, sent_ = 0, dropped_ = 0, refused_ = 0;
};

}  // namespace hapticd::sim::can
