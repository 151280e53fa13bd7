// The telemetry thread: drains the record ring, keeps the last seconds, writes them to a file when
// a fault appears, and appends every record to a file where the config asks for it.
//
// Files are never overwritten and never deleted. A flight recording is
// <flight_dir>/flight-<UTC>-<fault>.hapticrec; when the directory holds kMaxFlightFiles of them the
// next one is not written, and `failed` says what to do. A full recording whose path exists already
// gets the UTC time into its name.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "control/rt/spsc_ring.h"
#include "daemon/recording.h"

namespace hapticd::daemon {

inline constexpr std::size_t kMaxFlightFiles = 100;

struct TelemetryOptions {
  std::string flight_dir;   ///< empty: no flight recorder; made if only its last part is missing
  double flight_s = 5;      ///< seconds before the fault
  double after_s = 0.2;     ///< and after it
  std::string record_path;  ///< empty: no full recording
};

/// Told by the telemetry thread; the callbacks run in it.
struct TelemetryEvents {
  std::function<void(const std::string& path, std::uint64_t records)> flight_written;
  std::function<void(const Error& error)>
      failed;  ///< disk full and the like: told once per file, the loop goes on
  std::function<void(const std::byte* record)> record{};  ///< every one of them
};

class Telemetry {
 public:
  /// `ring` outlives this object, which is its only reader. Its slots hold header.record_bytes.
  Telemetry(TelemetryOptions options, RecordingHeader header, rt::SpscRing& ring,
            TelemetryEvents events);
  ~Telemetry();
  Telemetry(const Telemetry&) = delete;
  Telemetry& operator=(const Telemetry&) = delete;

  /// Opens the full recording, if any, and starts the thread. Where that fails there is no thread.
  Result<void> start();
  /// Drains what is left, finishes files, joins. Call it once the ring's writer has ended.
  void stop();
  /// After a reload: files from now on carry this header (same record layout). A full recording
  /// goes on in a new file, so that each file has one config.
  void set_header(RecordingHeader header);
  /// Records lost between loop and files, seen by gaps in RecordHeader::sequence.
  std::uint64_t lost() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticd::daemon
