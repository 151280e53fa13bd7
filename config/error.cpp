#include "config/error.h"

#include <sstream>

namespace hapticd::config {

std::string to_string(const ConfigError& error) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << error.file;
  if (error.line > 0) text << ':' << error.line << ':' << error.column;
  if (!error.path.empty()) text << ": " << error.path;
  text << ": " << error.message;
  return text.str();
}

}  // namespace hapticd::config
