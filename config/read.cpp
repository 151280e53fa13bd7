// A file, or a text, to a Document.
#include <algorithm>
#include <memory>
#include <utility>

#include "config/compilation.h"
#include "config/compile.h"
#include "config/digest.h"
#include "config/file_text.h"
#include "config/places.h"
#include "config/reader.h"
#include "config/yaml_tree.h"

namespace hapticd::config {
namespace {

void sort_by_place(std::vector<ConfigError>& errors) {
  std::stable_sort(errors.begin(), errors.end(), [](const ConfigError& a, const ConfigError& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

/// All of a text as one struct, with the places of its values.
template <class T>
Checked<std::shared_ptr<const Places>> read_yaml(const std::string& text, const std::string& path,
                                                 T& out) {
  YamlText yaml = parse_yaml(text, path);
  if (!yaml.sound) return tl::unexpected(std::move(yaml.errors));
  Reading reading(path);
  reading.errors = std::move(yaml.errors);
  read_value(reading, yaml.root, "", Key{}, out);
  if (!reading.errors.empty()) {
    sort_by_place(reading.errors);
    return tl::unexpected(std::move(reading.errors));
  }
  return std::make_shared<const Places>(std::move(reading.places));
}

/// In the config, about the file that it names at `path`.
ConfigError named_file_error(const Document& document, const std::string& path,
                             std::string message) {
  const Mark mark = document.places ? document.places->find(path) : Mark{};
  return {.file = document.path,
          .line = mark.line,
          .column = mark.column,
          .path = path,
          .message = std::move(message)};
}

/// A file that the config names at `path`; one that cannot be read is an error there.
template <class T>
Checked<std::shared_ptr<const Places>> read_named(const Document& document, const std::string& path,
                                                  const std::string& file, std::string& text,
                                                  T& out) {
  Checked<std::string> found = file_text(file);
  if (!found) {
    const ConfigError& error = found.error().front();
    return tl::unexpected(
        std::vector{named_file_error(document, path, error.file + ": " + error.message)});
  }
  text = std::move(*found);
  return read_yaml(text, file, out);
}

/// One axis; its errors go to `errors`.
void read_model(Document& document, const std::string& path, AxisModel& model,
                std::vector<ConfigError>& errors) {
  const std::string file = *model.file;
  if (model != AxisModel{.file = file}) {
    errors.push_back(named_file_error(
        document, path + ".file",
        "the other keys of a model stand in that file; remove them here, or the file"));
    return;
  }
  std::string text;
  ModelFile found;
  auto places = read_named(document, path + ".file", file, text, found);
  if (!places) {
    errors.insert(errors.end(), places.error().begin(), places.error().end());
    return;
  }
  model = std::move(found.model);
  document.models.push_back({.path = path,
                             .file = file,
                             .places = std::move(*places),
                             .measured = std::move(found.measured)});
}

}  // namespace

Checked<Document> read_text(std::string text, const std::string& path) {
  Document document{.path = path, .text = std::move(text)};
  auto places = read_yaml(document.text, path, document.config);
  if (!places) return tl::unexpected(std::move(places.error()));
  document.digest = digest_of(document.text);
  document.places = std::move(*places);
  return document;
}

std::vector<ConfigError> read_coupling(Document& document) {
  Coupling& coupling = *document.config.coupling;
  if (coupling != Coupling{.file = coupling.file}) {
    return {
        named_file_error(document, "coupling.file",
                         "blocks and solver stand in that file; remove them here, or the file")};
  }
  std::string text;
  CouplingFile file;
  auto places = read_named(document, "coupling.file", *coupling.file, text, file);
  if (!places) return std::move(places.error());
  coupling.blocks = std::move(file.blocks);
  coupling.solver = file.solver;
  if (file.assumed || file.certificate || file.digest) {
    document.designed = DesignedCoupling{.assumed = std::move(file.assumed),
                                         .certificate = std::move(file.certificate),
                                         .digest = file.digest.value_or(""),
                                         .actual_digest = digest_of_rest(text)};
  }
  document.coupling_places = std::move(*places);
  return {};
}

std::vector<ConfigError> read_models(Document& document) {
  std::vector<ConfigError> errors;
  for (std::size_t i = 0; i < document.config.devices.size(); ++i) {
    Device& device = document.config.devices[i];
    for (std::size_t k = 0; k < device.axes.size(); ++k) {
      std::optional<AxisModel>& model = device.axes[k].model;
      const std::string path = indexed("devices", i) + "." + indexed("axes", k) + ".model";
      if (model && model->file) read_model(document, path, *model, errors);
    }
  }
  return errors;
}

std::vector<ConfigError> read_proofs(Document& document) {
  const std::optional<std::string>& file = document.config.stability.proof;
  if (!file) return {};
  std::string text;
  ProofFile found;
  auto places = read_named(document, "stability.proof", *file, text, found);
  if (!places) return std::move(places.error());
  std::vector<std::string> names;
  for (const Device& device : document.config.devices) names.push_back(device.name);
  for (const DeviceProof& one : found.devices) {
    if (std::ranges::find(names, one.device) != names.end()) continue;
    return {named_file_error(document, "stability.proof",
                             *file + ": " + unknown_name("device", one.device, names))};
  }
  document.proofs = std::move(found.devices);
  return {};
}

Checked<Document> read_file(const std::string& path) {
  return file_text(path).and_then(
      [&](std::string text) { return read_text(std::move(text), path); });
}

}  // namespace hapticd::config
