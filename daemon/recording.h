// Recordings: one file format for the flight recorder, full recordings and simulations.
//
// A text header, one item a line, then packed records until the end of the file. The header says all that is needed to
// read the records, so a program of ten lines can:
//
//   hapticd-recording 1
//   rate_Hz 1000
//   config_digest 0123456789abcdef
//   config_bytes 1234
//   record_bytes 240
//   field <name> <unit> <type> <offset>      one line each; unit "-" for none; type i64 f64 i32 u32 u16 u8
//   header_bytes 4096                        of this whole header, config included; zero-padded to a multiple of 8
//   end
//   <the config's text, config_bytes long>
//
// A file that was cut short is readable up to its last whole record.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "control/build/program.h"
#include "control/core/result.h"

namespace hapticd::daemon {

struct Field {
  std::string name;  ///< "tick", "left.x.q"
  std::string unit;  ///< "m", "-" for none
  std::string type;  ///< i64 f64 i32 u32 u16 u8
  std::uint32_t offset = 0;
};

/// What stands in the header of a file.
struct RecordingHeader {
  double rate_Hz = 0;
  std::string config_digest;
  std::string config_text;
  std::uint32_t record_bytes = 0;
  std::vector<Field> fields;
};

/// The header of recordings of this program.
RecordingHeader recording_header(const build::Program& program, std::string config_digest, std::string config_text);

/// Writes one file. Nothing is lost on an error: what was written stays readable, and the error says how much that is.
class RecordingWriter {
 public:
  static Result<RecordingWriter> create(const std::string& path, const RecordingHeader& header);
  RecordingWriter(RecordingWriter&& other) noexcept;
  RecordingWriter& operator=(RecordingWriter&& other) noexcept;
  ~RecordingWriter();

  Result<void> append(const std::byte* record);
  /// Flushes and closes. The destructor does the same without telling of errors.
  Result<void> close();
  std::uint64_t records() const noexcept { return records_; }
  const std::string& path() const noexcept { return path_; }

 private:
  RecordingWriter() = default;
  Result<void> flush();
  int fd_ = -1;
  std::string path_;
  std::size_t record_bytes_ = 0;
  std::uint64_t records_ = 0;
  std::vector<std::byte> buffer_;
};

/// A whole file in memory.
struct Recording {
  RecordingHeader header;
  std::vector<std::byte> data;  ///< whole records only
  std::size_t torn_bytes = 0;   ///< cut off at the end

  std::size_t size() const noexcept { return header.record_bytes == 0 ? 0 : data.size() / header.record_bytes; }
  const Field* find(const std::string& name) const noexcept;
  /// Value of a field of record i, widened to double (an i64 beyond 2^53 loses its last digits).
  double value(std::size_t i, const Field& field) const noexcept;
};

Result<Recording> read_recording(const std::string& path);

/// Writes the records as CSV: a line of "name[unit]" and one line a record, numbers with 17 digits, no locale.
Result<void> write_csv(const Recording& recording, const std::string& path);

}  // namespace hapticd::daemon
