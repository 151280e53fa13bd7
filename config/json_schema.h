// The JSON schema of a config (draft 2020-12), for editors; generated from config/describe.h.
#pragma once
#include <string>

namespace hapticd::config {

/// The text of config/hapticd.schema.json, to the last byte.
std::string json_schema();

}  // namespace hapticd::config
