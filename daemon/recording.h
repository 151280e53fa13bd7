// Recordings: one file format for the flight recorder, full recordings and simulations.
//
// A text header, one item a line, in this order, then packed little-endian records until the end of
// the file. The header says all that is needed to read the records, so a program of ten lines can:
//
//   hapticd-recording 1
//   rate_Hz 1000
//   config_digest 0123456789abcdef      "-" for none
//   config_bytes 1234
//   record_bytes 240
//   field <name> <unit> <type> <offset> a line each; unit "-" for none;
//                                       type i64 f64 i32 u32 u16 u8
//   header_bytes 4096                   of all this, config and zeros up to a multiple of 8 included
//   end
//   <the config's text, config_bytes long>
//
// A file that was cut short is readable up to its last whole record.
//
// Fields: those of control::RecordHeader under their own names; per axis "left.x.raw" .age_ns
// .freshness .q .qd .effort .delivered; per contact coordinate "left.x.position" .scene_force
// .force; per device "left.digital" .armed .faulted .analogue0 to .analogue5. Enumerations are
// recorded as their numbers.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "control/build/program.h"
#include "control/core/result.h"
#include "daemon/output_file.h"

namespace hapticd::daemon {

struct Field {
  std::string name;  ///< "tick", "left.x.q"
  std::string unit;  ///< "m", "-" for none
  std::string type;  ///< i64 f64 i32 u32 u16 u8
  std::uint32_t offset = 0;
};

/// Size of a value of this type; 0: no such type.
std::size_t field_bytes(std::string_view type) noexcept;

/// What stands in the header of a file.
struct RecordingHeader {
  double rate_Hz = 0;
  std::string config_digest;
  std::string config_text;
  std::uint32_t record_bytes = 0;
  std::vector<Field> fields;
};

/// What a header must hold to be written, and whatever file it was read from: "" or what is wrong
/// with it.
std::string header_defect(const RecordingHeader& header);

/// The header of recordings of this program.
RecordingHeader recording_header(const build::Program& program, std::string config_digest,
                                 std::string config_text);

/// Writes one file. Nothing is lost on an error: what was written stays readable, and the error
/// says how much that is.
class RecordingWriter {
 public:
  static Result<RecordingWriter> create(const std::string& path, const RecordingHeader& header,
                                        IfExists if_exists = IfExists::replace);

  /// `record`: record_bytes of the header. After an error nothing more is written and each call
  /// tells it again.
  Result<void> append(const std::byte* record);
  /// Hands all that was appended to the kernel: it then survives the end of this process.
  Result<void> flush();
  /// Flushes and closes. The destructor does the same without telling of errors.
  Result<void> close();
  /// Appended without error. Up to a buffer's worth of them reaches the file with the next flush.
  std::uint64_t records() const noexcept { return records_; }
  const std::string& path() const noexcept { return file_.path(); }

 private:
  RecordingWriter(OutputFile file, std::size_t header_bytes, std::size_t record_bytes);
  Result<void> told(Result<void> result) const;

  OutputFile file_;
  std::size_t header_bytes_;
  std::size_t record_bytes_;
  std::uint64_t records_ = 0;
};

/// A whole file in memory.
struct Recording {
  RecordingHeader header;
  std::vector<std::byte> data;  ///< whole records only
  std::size_t torn_bytes = 0;   ///< cut off at the end

  std::size_t size() const noexcept {
    return header.record_bytes == 0 ? 0 : data.size() / header.record_bytes;
  }
  const Field* find(const std::string& name) const noexcept;
  /// Value of a field of record i, widened to double (an i64 beyond 2^53 loses its last digits).
  double value(std::size_t i, const Field& field) const noexcept;
};

/// Errors: no_input, no_permission, bad_data (with the line of the header and what was expected
/// there).
Result<Recording> read_recording(const std::string& path);

/// Writes the records as CSV: a line of "name[unit]", just "name" where there is no unit, and one
/// line a record; whole numbers as such, others with 17 digits, "nan" and "inf" for what is not
/// finite, no locale.
Result<void> write_csv(const Recording& recording, const std::string& path);

}  // namespace hapticd::daemon
