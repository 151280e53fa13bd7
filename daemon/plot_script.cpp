#include "daemon/plot_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hapticd::daemon {
namespace {

/// Colours that are told apart by most eyes (Okabe and Ito 2008).
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#e69f00", "#56b4e9", "#000000", "#999999"};

std::string colour(std::size_t i) {
  return fmt::format("rgb '{}'", kColours[i % std::size(kColours)]);
}

/// $p<panel>c<curve>
std::string block_name(std::size_t panel, std::size_t curve) {
  return fmt::format("$p{}c{}", panel, curve);
}

std::string data_block(const std::string& name, const Curve& curve) {
  std::string text = name + " << EOD\n";
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!std::isfinite(curve.y[i]) || !std::isfinite(curve.x[i])) {
      text += "\n";  // an empty line is a gap
      continue;
    }
    text += fmt::format("{:.9g} {:.9g}", curve.x[i], curve.y[i]);
    if (!curve.labels.empty()) {
      std::string label = curve.labels[i];
      std::replace_if(
          label.begin(), label.end(),
          [](char c) { return c == '"' || static_cast<unsigned char>(c) < ' '; }, ' ');
      text += " \"" + label + "\"";
    }
    text += "\n";
  }
  return text + "EOD\n";
}

/// Lowest and highest x of all, so that all panels show the same range; around points there is room,
/// for those at the rim and their labels.
std::string x_range(const Picture& picture) {
  double low = INFINITY, high = -INFINITY;
  for (const Panel& panel : picture.panels) {
    for (const Curve& curve : panel.curves) {
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (!std::isfinite(curve.y[i]) || !std::isfinite(curve.x[i])) continue;
        low = std::min(low, curve.x[i]);
        high = std::max(high, curve.x[i]);
      }
    }
  }
  if (picture.scatter) {
    const double room = picture.log_x ? 0.05 * std::log(high / low) : 0.05 * (high - low);
    low = picture.log_x ? low * std::exp(-room) : low - room;
    high = picture.log_x ? high * std::exp(room) : high + room;
  }
  return high > low ? fmt::format("set xrange [{:.9g}:{:.9g}]\n", low, high) : "";
}

std::string marks_text(const Picture& picture) {
  std::string text;
  for (const Mark& mark : picture.marks) {
    if (mark.kind == Mark::Kind::fault) {
      text += fmt::format(
          "set arrow from {0:.9g}, graph 0 to {0:.9g}, graph 1 nohead front linewidth 2 "
          "linecolor rgb '#cc0000'\n"
          "set label {1} at {0:.9g}, graph 0.95 offset character 0.5, 0 front textcolor rgb "
          "'#cc0000'\n",
          mark.from, quoted(mark.text));
    } else {
      text += fmt::format(
          "set object rectangle from {:.9g}, graph 0 to {:.9g}, graph 1 behind fillstyle solid "
          "0.25 noborder fillcolor rgb '#e69f00'\n",
          mark.from, mark.to);
    }
  }
  return text;
}

/// The file, and what its shades stand for.
std::string title_text(const Picture& picture) {
  std::string limits;
  for (const Mark& mark : picture.marks) {
    if (mark.kind == Mark::Kind::limit && !mark.text.empty())
      limits += (limits.empty() ? ", shaded: " : ", ") + mark.text;
  }
  return picture.title + limits;
}

std::string curve_text(const Picture& picture, std::size_t panel, std::size_t curve) {
  const Curve& drawn = picture.panels[panel].curves[curve];
  const std::string name = block_name(panel, curve);
  std::string text = fmt::format("{} using 1:2 with {} linecolor {} title {}", name,
                                 picture.scatter ? "points pointtype 7" : "lines", colour(curve),
                                 quoted(drawn.title));
  if (!drawn.labels.empty())
    text += ", " + name + " using 1:2:3 with labels left offset character 1, 0 notitle";
  return text;
}

std::string panel_text(const Picture& picture, std::size_t index) {
  const Panel& panel = picture.panels[index];
  const bool last = index + 1 == picture.panels.size();
  std::string text = "set ylabel " + quoted(panel.label) + "\n";
  text += last ? "set xlabel " + quoted(picture.x_label) + "\n" : "unset xlabel\n";
  text += "plot ";
  for (std::size_t i = 0; i < panel.curves.size(); ++i)
    text += (i == 0 ? "" : ", ") + curve_text(picture, index, i);
  return text + "\n";
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string literal = "'";
  for (const char c : text) {
    if (c == '\'') literal += '\'';
    literal += static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? ' ' : c;
  }
  return literal + "'";
}

std::string gnuplot_script(const Picture& picture, PictureFormat format, std::size_t width,
                           std::size_t height) {
  const std::string size = fmt::format("size {},{} noenhanced", width, height);
  std::string text = format == PictureFormat::png
                         ? "set terminal pngcairo " + size + " background rgb 'white'\n"
                         : "set terminal svg " + size + " background rgb 'white'\n";
  text +=
      "set encoding utf8\nset grid\nset key outside right top\n"
      "set lmargin at screen 0.1\nset rmargin at screen 0.76\n";
  if (picture.log_x) text += "set logscale x\n";
  if (picture.log_y) text += "set logscale y\n";
  for (std::size_t p = 0; p < picture.panels.size(); ++p) {
    for (std::size_t c = 0; c < picture.panels[p].curves.size(); ++c)
      text += data_block(block_name(p, c), picture.panels[p].curves[c]);
  }
  text += x_range(picture) + marks_text(picture);
  text += fmt::format("set multiplot layout {},1 title {}\n", picture.panels.size(),
                      quoted(title_text(picture)));
  for (std::size_t p = 0; p < picture.panels.size(); ++p) text += panel_text(picture, p);
  return text + "unset multiplot\n";
}

}  // namespace hapticd::daemon
