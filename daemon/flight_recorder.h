// The flight recorder: keeps the last seconds of records in memory and writes them to a file when a
// fault appears. Single-threaded; the telemetry thread owns it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/telemetry.h"

namespace hapticd::daemon {

class FlightRecorder {
 public:
  /// Allocates its whole history here.
  FlightRecorder(const TelemetryOptions& options, const RecordingHeader& header,
                 const TelemetryEvents& events);

  /// Takes one record. A fault that was not there one record before starts a file.
  void add(const std::byte* record, const RecordingHeader& header);
  /// Writes some of what is due, and ends the file once it is complete. To be called between
  /// batches of add().
  void pump();
  /// Ends a file that is under way, with all the records there are.
  void finish();

 private:
  void begin(Fault fault, const RecordingHeader& header);
  void write_until(std::uint64_t end);
  void give_up(const Error& error);

  const TelemetryEvents& events_;
  std::string dir_;
  std::size_t record_bytes_;
  std::uint64_t before_ = 0, after_ = 0;  ///< records
  std::uint64_t capacity_ = 0;            ///< of the history, in records
  std::vector<std::byte> history_;
  std::uint64_t total_ = 0;  ///< records seen; record i is in slot i % capacity_
  Fault last_fault_ = Fault::none;
  std::optional<RecordingWriter> file_;
  std::uint64_t next_ = 0,
                end_ = 0;  ///< of file_: the next record to write and the first one beyond it
};

}  // namespace hapticd::daemon
