#include "daemon/flight_recorder.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "control/core/fault.h"
#include "control/record.h"
#include "daemon/file_names.h"

namespace hapticd::daemon {
namespace {

/// What pump() writes at most in one go: the ring is drained again before the disk can make it
/// overflow.
constexpr std::uint64_t kPumpBytes = 1024 * 1024;

std::uint64_t records_in(double seconds, double rate_Hz) {
  return static_cast<std::uint64_t>(std::ceil(std::max(seconds, 0.0) * rate_Hz));
}

std::size_t flight_files(const std::string& dir) {
  std::size_t count = 0;
  std::error_code ignored;
  for (const auto& file : std::filesystem::directory_iterator(dir, ignored)) {
    const std::string name = file.path().filename();
    count += name.starts_with("flight-") && name.ends_with(".hapticrec") ? 1 : 0;
  }
  return count;
}

Result<RecordingWriter> create_file(const std::string& dir, Fault fault,
                                    const RecordingHeader& header) {
  if (::mkdir(dir.c_str(), 0755) != 0 && errno != EEXIST) {
    return fail(ExitCode::cannot_create, dir + ": cannot be made: " + errno_text(errno));
  }
  if (flight_files(dir) >= kMaxFlightFiles) {
    return fail(ExitCode::cannot_create,
                dir + ": holds " + std::to_string(kMaxFlightFiles) +
                    " flight recordings, no more are written; move them away or delete them");
  }
  const std::string stem = dir + "/flight-" + utc_stamp() + "-" + std::string(entry(fault).name);
  return create_unique(stem, ".hapticrec", header);
}

}  // namespace

FlightRecorder::FlightRecorder(const TelemetryOptions& options, const RecordingHeader& header,
                               const TelemetryEvents& events)
    : events_(events), dir_(options.flight_dir), record_bytes_(header.record_bytes) {
  if (dir_.empty()) return;
  before_ = records_in(options.flight_s, header.rate_Hz);
  after_ = records_in(options.after_s, header.rate_Hz);
  // A second more than a file begins with: so long the disk may take before records are overwritten
  // under it.
  capacity_ = before_ + records_in(1, header.rate_Hz) + 1;
  history_.resize(capacity_ * record_bytes_);
}

void FlightRecorder::add(const std::byte* record, const RecordingHeader& header) {
  if (dir_.empty()) return;
  std::memcpy(history_.data() + (total_ % capacity_) * record_bytes_, record, record_bytes_);
  ++total_;
  Fault fault = Fault::none;
  std::memcpy(&fault, record + offsetof(control::RecordHeader, fault), sizeof fault);
  if (fault != Fault::none && last_fault_ == Fault::none) begin(fault, header);
  last_fault_ = fault;
}

void FlightRecorder::begin(Fault fault, const RecordingHeader& header) {
  end_ = total_ + after_;
  if (file_)
    return;  // the next fault came before the last one's file was complete: it goes on in that file
  next_ = total_ - std::min(total_, before_ + 1);
  auto file = create_file(dir_, fault, header);
  if (!file) return give_up(file.error());
  file_.emplace(std::move(*file));
}

void FlightRecorder::pump() {
  if (!file_) return;
  write_until(std::min(end_, next_ + std::max<std::uint64_t>(kPumpBytes / record_bytes_, 1)));
  if (file_ && next_ == end_) finish();
}

void FlightRecorder::finish() {
  if (!file_) return;
  write_until(end_);
  if (!file_) return;
  if (auto closed = file_->close(); !closed) return give_up(closed.error());
  if (events_.flight_written) events_.flight_written(file_->path(), file_->records());
  file_.reset();
}

void FlightRecorder::write_until(std::uint64_t end) {
  // Records that were overwritten before the disk took them are left out; their sequence numbers
  // show the gap.
  if (total_ > capacity_) next_ = std::max(next_, total_ - capacity_);
  for (end = std::min(end, total_); next_ < end; ++next_) {
    auto written = file_->append(history_.data() + (next_ % capacity_) * record_bytes_);
    if (!written) return give_up(written.error());
  }
}

void FlightRecorder::give_up(const Error& error) {
  file_.reset();
  if (events_.failed) events_.failed(error);
}

}  // namespace hapticd::daemon
