// Config -> what runs: the program for the loop, options for devices and daemon, and what the
// stability check assumes.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "config/error.h"
#include "config/schema.h"
#include "control/build/program.h"
#include "control/design/check/stability.h"
#include "sim/options.h"

namespace hapticd::config {

class Places;

/// A file as read: the struct, its exact text and a digest of the text (recordings carry both).
struct Document {
  std::string path{};
  std::string text{};
  std::string digest{};  ///< 16 hexadecimal digits, FNV-1a 64 of `text`
  Config config{};
  std::shared_ptr<const Places>
      places{};  ///< line and column of each value, for errors; empty: not from a file
};

/// All that a run needs. `simulated[i]` belongs to device i.
struct Compiled {
  Document document;
  std::unique_ptr<build::Program> program;
  std::vector<sim::DeviceOptions> simulated;
  std::vector<check::DeviceAssumption> assumed;
};

/// Reads one file strictly: every error of the file at once, or the document.
Checked<Document> read_file(const std::string& path);
/// The same from text; `path` only names it in errors.
Checked<Document> read_text(std::string text, const std::string& path);

/// Checks what needs more than one key (names, references, capacities) and builds the program.
Checked<Compiled> compile(Document document);

/// read_file and compile.
Checked<Compiled> load(const std::string& path);

}  // namespace hapticd::config
