// Structs of a config as YAML, to the last digit: what is written is read back as the same struct.
#pragma once
#include <string>

#include "config/schema.h"

namespace hapticd::config {

/// Keys whose value is null or an empty list are left out: that is their default.
std::string to_yaml(const CouplingFile& file);
std::string to_yaml(const ModelFile& file);
std::string to_yaml(const ProofFile& file);
std::string to_yaml(const Config& config);
/// The list of objects alone.
std::string to_yaml(const std::vector<SceneObject>& scene);

}  // namespace hapticd::config
