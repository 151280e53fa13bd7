// The key reference of hapticd.yaml(5), generated from config/describe.h.
#pragma once
#include <string>

namespace hapticd::config {

/// What stands around the generated part of systemd/hapticd.yaml.5.scd.
inline constexpr const char* kManBegin =
    "; begin of the generated key reference (hapticd_config_schema --man)\n";
inline constexpr const char* kManEnd = "; end of the generated key reference\n";

/// The generated part, in scdoc's form, without the marks around it.
std::string man_keys();

}  // namespace hapticd::config
