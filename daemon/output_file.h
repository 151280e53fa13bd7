// A file that is written from front to back, buffered, with the errors that disks have: interrupted
// and short writes are carried on, anything else is told once with path and reason, and afterwards
// the file is left as it is.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "control/core/result.h"

namespace hapticd::daemon {

enum class IfExists : std::uint8_t { replace, refuse };

class OutputFile {
 public:
  /// Errors: cannot_create, no_permission. With `refuse` an existing file is an error and stays as
  /// it is.
  static Result<OutputFile> create(const std::string& path, IfExists if_exists);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  /// Flushes and closes without telling of errors.
  ~OutputFile();

  Result<void> write(const void* data, std::size_t size);
  Result<void> write(std::string_view text) { return write(text.data(), text.size()); }
  Result<void> flush();
  Result<void> close();

  /// Bytes that the kernel has taken: they survive the end of this process.
  std::uint64_t written() const noexcept { return written_; }
  const std::string& path() const noexcept { return path_; }

 private:
  OutputFile(int fd, std::string path);
  Result<void> give_up(int reason);

  int fd_ = -1;
  int failed_ = 0;  ///< errno of the first error; no byte is written after it
  std::string path_;
  std::uint64_t written_ = 0;
  std::vector<std::byte> buffer_;
};

/// Writes beside `path` and renames: whoever looks finds the old file or the new one, never half of
/// it. Follows a link; a device, a pipe or a directory is refused. Errors as of OutputFile; nothing is left behind.
Result<void> replace_file(const std::string& path, std::string_view text);

/// "No space left on device" and the like.
std::string errno_text(int reason);

}  // namespace hapticd::daemon
