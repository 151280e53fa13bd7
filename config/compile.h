// Config -> what runs: the program for the loop, options for devices and daemon, and what the
// stability check assumes.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/error.h"
#include "config/schema.h"
#include "control/build/program.h"
#include "control/design/check/stability.h"
#include "drivers/can/budget.h"
#include "drivers/can/options.h"
#include "drivers/usb/options.h"
#include "sim/options.h"

namespace hapticd::check {
struct Certificate;
}

namespace hapticd::config {

class Places;

/// What `hapticctl design` wrote into the coupling file beside the coupling.
struct DesignedCoupling {
  std::optional<Assumed> assumed{};
  std::optional<CouplingCertificate> certificate{};
  std::string digest{};  ///< as written
  std::string actual_digest{};
};

/// A model file that a config names.
struct NamedModel {
  std::string path;  ///< of the model in the config: "devices[0].axes[1].model"
  std::string file;
  std::shared_ptr<const Places> places{};
  std::optional<Measurement> measured{};
};

/// A file as read: the struct, its exact text and a digest of the text (recordings carry both).
struct Document {
  std::string path{};
  std::string text{};
  std::string digest{};  ///< 16 hexadecimal digits, FNV-1a 64 of `text`
  Config config{};
  std::shared_ptr<const Places>
      places{};  ///< line and column of each value, for errors; empty: not from a file
  /// Likewise, of the coupling file; empty: the coupling is not from a file of its own.
  std::shared_ptr<const Places> coupling_places{};
  std::optional<DesignedCoupling> designed{};
  std::vector<NamedModel> models{};   ///< files of models, once compile() has read them
  std::vector<DeviceProof> proofs{};  ///< of stability.proof, likewise
};

/// All that a run needs. `simulated[i]` belongs to device i.
struct Compiled {
  Document document;
  std::unique_ptr<build::Program> program;
  std::vector<sim::DeviceOptions> simulated;
  std::optional<sim::SharedHandOptions> shared_hand;   ///< of the simulated devices
  std::vector<std::optional<can::DeviceOptions>> can;  ///< `can[i]` belongs to device i
  std::vector<can::BusLoad> buses;
  std::vector<std::optional<usb::DeviceOptions>> usb;  ///< likewise
  double collect_s = 0;  ///< the loop waits so long for samples, from its tick's start
  std::vector<check::DeviceAssumption> assumed;
  /// Of a designed coupling; the check goes by it only as far as it holds.
  std::shared_ptr<const check::Certificate> certificate;
  std::string certificate_problem;  ///< why the file's certificate does not count; empty: it does
};

/// Reads one file strictly: every error of the file at once, or the document.
Checked<Document> read_file(const std::string& path);
/// The same from text; `path` only names it in errors.
Checked<Document> read_text(std::string text, const std::string& path);

/// Reads the files that the config names, checks what needs more than one key (names, references,
/// capacities) and builds the program.
Checked<Compiled> compile(Document document);

/// What a coupling that is designed for this config assumes of it.
Assumed assumptions(const Compiled& compiled);

/// read_file and compile.
Checked<Compiled> load(const std::string& path);

}  // namespace hapticd::config
