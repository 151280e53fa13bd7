// A picture in gnuplot's words. Data stand in the script itself; the picture goes to standard
// output, so no name of a file is ever part of a script.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "daemon/plot.h"

namespace hapticd::daemon {

enum class PictureFormat : std::uint8_t { png, svg };

std::string gnuplot_script(const Picture& picture, PictureFormat format, std::size_t width,
                           std::size_t height);

/// Text as a gnuplot literal: 'it''s'. What would end a line becomes a space.
std::string quoted(const std::string& text);

}  // namespace hapticd::daemon
