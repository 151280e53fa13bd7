#include "daemon/telemetry.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "control/record.h"
#include "daemon/file_names.h"
#include "daemon/flight_recorder.h"

namespace hapticd::daemon {

using namespace std::chrono_literals;

struct Telemetry::Impl {
  Impl(TelemetryOptions given, RecordingHeader first, rt::SpscRing& records,
       TelemetryEvents callbacks)
      : options(std::move(given)),
        header(std::move(first)),
        ring(records),
        events(std::move(callbacks)),
        flight(options, header, events) {}

  void body() noexcept;
  void drain();
  void count_gap(const std::byte* record) noexcept;
  void adopt_header();
  void flush_recording();
  void record_failed(const Error& error);
  void tell(const Error& error) const;

  const TelemetryOptions options;
  RecordingHeader header;
  rt::SpscRing& ring;
  const TelemetryEvents events;
  FlightRecorder flight;
  std::optional<RecordingWriter> recording;
  std::chrono::steady_clock::time_point flushed{};
  std::optional<std::uint32_t> last_sequence;

  std::atomic<std::uint64_t> lost{0};
  std::atomic<bool> run{true};
  std::mutex header_mutex;  ///< of the two below; between supervisor and telemetry thread only
  RecordingHeader next_header;
  bool has_next_header = false;
  std::thread thread;
};

void Telemetry::Impl::body() noexcept {
  constexpr auto kPoll = 2ms;
  try {
    while (run.load(std::memory_order_acquire)) {
      adopt_header();
      drain();
      flight.pump();
      flush_recording();
      std::this_thread::sleep_for(kPoll);
    }
    drain();
    flight.finish();
    if (recording) {
      if (auto closed = recording->close(); !closed) tell(closed.error());
    }
  } catch (const std::exception& error) {
    // Out of memory while a file was opened, most likely. The loop must not end for want of a
    // recording; the ring then runs full and counts what it drops.
    tell({std::string("telemetry ended: ") + error.what(), ExitCode::software});
  }
}

void Telemetry::Impl::drain() {
  // At most one ring's worth: a writer that is faster than this thread must not keep it from its
  // other work.
  for (std::size_t i = 0; i < ring.slots(); ++i) {
    const std::byte* record = ring.front();
    if (record == nullptr) return;
    count_gap(record);
    if (events.record) events.record(record);
    flight.add(record, header);
    if (recording) {
      if (auto written = recording->append(record); !written) record_failed(written.error());
    }
    ring.pop();
  }
}

void Telemetry::Impl::count_gap(const std::byte* record) noexcept {
  std::uint32_t sequence = 0;
  std::memcpy(&sequence, record + offsetof(control::RecordHeader, sequence), sizeof sequence);
  if (last_sequence) {
    const std::uint32_t gap =
        sequence - *last_sequence - 1;  // right across the wrap of the counter
    lost.fetch_add(gap, std::memory_order_relaxed);
  }
  last_sequence = sequence;
}

void Telemetry::Impl::adopt_header() {
  {
    const std::lock_guard lock(header_mutex);
    if (!has_next_header) return;
    header = std::move(next_header);
    has_next_header = false;
  }
  if (!recording) return;
  auto closed = recording->close();
  recording.reset();
  if (!closed) return tell(closed.error());
  auto next = create_beside(options.record_path, header);
  if (!next) return tell(next.error());
  recording.emplace(std::move(*next));
}

void Telemetry::Impl::flush_recording() {
  // So often that a killed daemon loses little, so rarely that it costs nothing.
  constexpr auto kEvery = 200ms;
  const auto now = std::chrono::steady_clock::now();
  if (!recording || now - flushed < kEvery) return;
  flushed = now;
  if (auto done = recording->flush(); !done) record_failed(done.error());
}

void Telemetry::Impl::record_failed(const Error& error) {
  recording.reset();
  tell(error);
}

void Telemetry::Impl::tell(const Error& error) const {
  if (events.failed) events.failed(error);
}

Telemetry::Telemetry(TelemetryOptions options, RecordingHeader header, rt::SpscRing& ring,
                     TelemetryEvents events)
    : impl_(
          std::make_unique<Impl>(std::move(options), std::move(header), ring, std::move(events))) {}

Telemetry::~Telemetry() {
  stop();
}

Result<void> Telemetry::start() {
  if (!impl_->options.record_path.empty()) {
    auto recording = create_beside(impl_->options.record_path, impl_->header);
    if (!recording) return tl::unexpected(recording.error());
    impl_->recording.emplace(std::move(*recording));
  }
  // No signal is handled in this thread, and one that a full disk raises (SIGXFSZ) becomes
  // write()'s error. The mask is inherited, so it is set around the start.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  impl_->thread = std::thread([impl = impl_.get()] { impl->body(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::pthread_setname_np(impl_->thread.native_handle(), "telemetry");
  return {};
}

void Telemetry::stop() {
  impl_->run.store(false, std::memory_order_release);
  if (impl_->thread.joinable()) impl_->thread.join();
}

void Telemetry::set_header(RecordingHeader header) {
  const std::lock_guard lock(impl_->header_mutex);
  impl_->next_header = std::move(header);
  impl_->has_next_header = true;
}

std::uint64_t Telemetry::lost() const noexcept {
  return impl_->lost.load(std::memory_order_relaxed);
}

}  // namespace hapticd::daemon
