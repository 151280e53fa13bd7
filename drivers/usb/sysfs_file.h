// Files and links of sysfs, on the premise that whoever plugged the device in chose what is in them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hapticd::usb::sysfs {

/// Of a longer file only so many; empty: it cannot be read.
std::vector<std::uint8_t> bytes_of(const std::string& file, std::size_t most);
/// The lines of a small file; what is not printable ASCII reads as '?'.
std::vector<std::string> lines_of(const std::string& file);
/// The first line without blanks around it; "" where there is none.
std::string text_of(const std::string& file);
/// Nothing: no file, or it is not this number alone, or more than `most`.
std::optional<std::uint32_t> number_of(const std::string& file, int base, std::uint32_t most);
/// The same of a text.
std::optional<std::uint32_t> number_in(const std::string& text, int base, std::uint32_t most);
/// Sorted; empty where there is no such directory.
std::vector<std::string> names_in(const std::string& directory);
/// Without links; "" where one leads nowhere.
std::string real_path(const std::string& path);
/// The last part of a path.
std::string name_of(const std::string& path);
/// The path without it.
std::string parent_of(const std::string& path);

}  // namespace hapticd::usb::sysfs
