#include "daemon/plot.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "daemon/plot_csv.h"
#include "daemon/plot_recording.h"

namespace hapticd::daemon {
namespace {

constexpr std::string_view kRecordingMagic = "hapticd-recording ";
constexpr std::size_t kPanelHeight = 200, kMargins = 100;

bool is_recording(const std::string& path) {
  std::string begin(kRecordingMagic.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == kRecordingMagic;
}

/// Keeps the first, lowest and highest of the points that fall into one column.
class Columns {
 public:
  Columns(const Curve& curve, std::size_t count)
      : from_(curve.x.front()),
        scale_(static_cast<double>(count) / (curve.x.back() - curve.x.front())),
        last_(count - 1) {
    kept_.title = curve.title;
  }

  void add(double x, double y) {
    const auto column = std::min(last_, static_cast<std::size_t>((x - from_) * scale_));
    if (column != column_ || !std::isfinite(y)) finish();
    column_ = column;
    if (!std::isfinite(y)) {
      keep({x, y});
    } else if (!any_) {
      low_ = high_ = {x, y};
      any_ = true;
    } else {
      if (y < low_.y) low_ = {x, y};
      if (y > high_.y) high_ = {x, y};
    }
  }
  Curve result() {
    finish();
    return std::move(kept_);
  }

 private:
  struct Point {
    double x, y;
  };
  void keep(const Point& p) {
    kept_.x.push_back(p.x);
    kept_.y.push_back(p.y);
  }
  void finish() {
    if (!any_) return;
    any_ = false;
    const bool rising = low_.x <= high_.x;
    keep(rising ? low_ : high_);
    if (low_.x != high_.x) keep(rising ? high_ : low_);
  }

  const double from_, scale_;
  const std::size_t last_;
  Curve kept_;
  std::size_t column_ = 0;
  Point low_{}, high_{};
  bool any_ = false;
};

/// A gap in every tick of a column would still be many points.
void merge_gaps(Curve& curve) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (kept > 0 && !std::isfinite(curve.y[i]) && !std::isfinite(curve.y[kept - 1])) continue;
    curve.x[kept] = curve.x[i];
    curve.y[kept++] = curve.y[i];
  }
  curve.x.resize(kept);
  curve.y.resize(kept);
}

bool draws(const Panel& panel) {
  return std::any_of(panel.curves.begin(), panel.curves.end(), [](const Curve& curve) {
    return std::any_of(curve.y.begin(), curve.y.end(), [](double y) { return std::isfinite(y); });
  });
}

/// A logarithm of what is not above zero is a gap.
void leave_out_nonpositive(Curve& curve, bool log_x, bool log_y) {
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if ((log_x && !(curve.x[i] > 0)) || (log_y && !(curve.y[i] > 0)))
      curve.y[i] = std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

void decimate(Curve& curve, std::size_t columns) {
  if (curve.x.size() <= 2 * columns || !curve.labels.empty()) return;
  if (!(curve.x.back() > curve.x.front())) return;
  Columns kept(curve, columns);
  for (std::size_t i = 0; i < curve.x.size(); ++i) kept.add(curve.x[i], curve.y[i]);
  curve = kept.result();
  merge_gaps(curve);
}

std::size_t picture_height(const Picture& picture, const PlotOptions& options) {
  const std::size_t panels = std::max<std::size_t>(2, picture.panels.size());
  return options.height > 0 ? options.height : kMargins + panels * kPanelHeight;
}

Result<Picture> read_picture(const std::string& path, const PlotOptions& options) {
  std::error_code absent;  // told by who reads it
  const auto status = std::filesystem::status(path, absent);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return fail(ExitCode::no_input, path + ": is not a regular file");
  auto picture = is_recording(path) ? recording_picture(path, options) : csv_picture(path, options);
  if (!picture) return picture;
  picture->log_x = options.log_x;
  picture->log_y = options.log_y;
  picture->scatter = options.scatter;
  for (Panel& panel : picture->panels) {
    for (Curve& curve : panel.curves) {
      leave_out_nonpositive(curve, options.log_x, options.log_y);
      if (!options.scatter && std::is_sorted(curve.x.begin(), curve.x.end()))
        decimate(curve, options.width);
    }
  }
  std::erase_if(picture->panels, [](const Panel& panel) { return !draws(panel); });
  if (!picture->panels.empty()) return picture;
  return fail(ExitCode::bad_data,
              path + ": nothing to draw: no finite value in that range" +
                  (options.log_x || options.log_y ? " that is above zero" : ""));
}

}  // namespace hapticd::daemon
