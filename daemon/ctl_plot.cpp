#include "daemon/ctl_plot.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>
#include <string_view>
#include <system_error>

#include "daemon/ctl_verbs.h"
#include "daemon/output_file.h"
#include "daemon/plot_gnuplot.h"
#include "daemon/plot_script.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {
namespace {

std::optional<PictureFormat> format_of(const std::string& path) {
  if (path.ends_with(".png")) return PictureFormat::png;
  if (path.ends_with(".svg")) return PictureFormat::svg;
  return std::nullopt;
}

bool parse_side(std::string_view text, std::size_t& side) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  return error == std::errc() && end == text.data() + text.size() && side >= 100 && side <= 9999;
}

std::size_t points_of(const Picture& picture) {
  std::size_t points = 0;
  for (const Panel& panel : picture.panels) {
    for (const Curve& curve : panel.curves) points += curve.x.size();
  }
  return points;
}

void print_done(const Picture& picture, const std::string& output, bool json) {
  if (!json) {
    std::fprintf(stderr, "%s: %zu panels, %zu points\n", output.c_str(), picture.panels.size(),
                 points_of(picture));
    return;
  }
  Json panels = Json::array();
  for (const Panel& panel : picture.panels) {
    Json curves = Json::array();
    for (const Curve& curve : panel.curves) curves.push_back(curve.title);
    panels.push_back({{"label", panel.label}, {"curves", std::move(curves)}});
  }
  std::puts(to_text({{"ok", true},
                     {"output", output},
                     {"panels", std::move(panels)},
                     {"points", points_of(picture)}})
                .c_str());
}

}  // namespace

std::string set_size(PlotOptions& options, const std::string& size) {
  const std::size_t cross = std::min(size.find('x'), size.size());
  const std::string_view all = size;
  const bool good = parse_side(all.substr(0, cross), options.width) && cross < size.size() &&
                    parse_side(all.substr(cross + 1), options.height);
  return good ? "" : "expected WIDTHxHEIGHT in pixels, 100 to 9999 each, found " + size;
}

std::string set_log_axes(PlotOptions& options, const std::string& axes) {
  options.log_x = axes == "x" || axes == "xy";
  options.log_y = axes == "y" || axes == "xy";
  return options.log_x || options.log_y ? "" : "expected x, y or xy, found " + axes;
}

ExitCode run_plot(const std::string& path, const PlotOptions& options, bool json) {
  const std::string output = options.output.empty() ? path + ".png" : options.output;
  const auto format = format_of(output);
  if (!format) {
    return print_error({"expected --out to end in .png or .svg, found " + output, ExitCode::usage},
                       json);
  }
  const auto picture = read_picture(path, options);
  if (!picture) return print_error(picture.error(), json);
  const auto drawn = run_gnuplot(
      gnuplot_script(*picture, *format, options.width, picture_height(*picture, options)));
  if (!drawn) return print_error(drawn.error(), json);
  if (auto written = replace_file(output, *drawn); !written)
    return print_error(written.error(), json);
  print_done(*picture, output, json);
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
