// A picture as data: panels of curves over one axis, with marks. How it comes about is told in
// plot_recording.h and plot_csv.h; plot_script.h turns it into gnuplot's words.
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "control/core/result.h"

namespace hapticd::daemon {

/// y over x; both equally long. A y that is not finite is a gap.
struct Curve {
  std::string title;
  std::vector<double> x{}, y{};
  std::vector<std::string> labels{};  ///< beside its points; empty: none
};

struct Panel {
  std::string label;  ///< of the y axis, with its unit
  std::vector<Curve> curves{};
};

/// Over all panels: a line where `to` is `from`, else a shade.
struct Mark {
  enum class Kind : std::uint8_t { fault, limit } kind = Kind::fault;
  double from = 0, to = 0;  ///< in x
  std::string text;         ///< empty: said by another mark
};

struct Picture {
  std::string title;
  std::string x_label;
  std::vector<Panel> panels{};
  std::vector<Mark> marks{};
  bool log_x = false, log_y = false;
  bool scatter = false;  ///< points instead of lines
};

/// What of a file is drawn.
struct PlotOptions {
  std::string output{};                                    ///< .png or .svg; empty: FILE.png
  std::vector<std::string> fields{};                       ///< a panel each; empty: the usual ones
  double from = -std::numeric_limits<double>::infinity();  ///< of x; recordings: s from the start
  double to = std::numeric_limits<double>::infinity();
  bool log_x = false, log_y = false;
  bool scatter = false;
  std::size_t width = 1200;  ///< pixels
  std::size_t height = 0;    ///< 0: by the number of panels
};

/// At most two points for each of `columns` equal parts of the range of x: the lowest and the
/// highest y in it, in their order, so that no peak is lost. Ascending x; gaps stay gaps. A curve
/// that has no more points than that is left as it is.
void decimate(Curve& curve, std::size_t columns);

/// The picture of a recording or a CSV file. Errors: no_input, no_permission, bad_data (neither of
/// both, or nothing to draw), usage (a field that the file does not have).
Result<Picture> read_picture(const std::string& path, const PlotOptions& options);

/// Pixels of a picture in which `options` leave them open.
std::size_t picture_height(const Picture& picture, const PlotOptions& options);

}  // namespace hapticd::daemon
