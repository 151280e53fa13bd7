// Networks of masses, springs and dampers between coordinates, nodes and ground.
#include <algorithm>

#include "config/coordinates.h"
#include "config/describe.h"
#include "config/scene_compilation.h"

namespace hapticd::config {
namespace {

using build::NetworkEnd;

class NetworkCompiler {
 public:
  NetworkCompiler(Compilation& compilation, const Network& network, const std::string& path)
      : compilation_(compilation), network_(network), path_(path) {}

  void compile() {
    add_nodes();
    for (std::size_t i = 0; i < network_.elements.size(); ++i) add_element(i);
    if (!sound_) return;
    check_felt();
    check_determined();
    compilation_.spec.networks.push_back(std::move(made_));
  }

 private:
  void refuse(const std::string& path, std::string message) {
    sound_ = false;
    compilation_.refuse(path, std::move(message));
  }

  void add_nodes() {
    for (std::size_t i = 0; i < network_.nodes.size(); ++i) {
      const NetworkNode& node = network_.nodes[i];
      const std::string place = indexed(path_ + ".nodes", i) + ".name";
      const auto& devices = compilation_.spec.device_names;
      if (node.name == "ground" ||
          std::find(devices.begin(), devices.end(), node.name) != devices.end()) {
        refuse(place, "'" + node.name + "' has a meaning of its own; give the node another name");
      } else if (std::find(names_.begin(), names_.end(), node.name) != names_.end()) {
        refuse(place, "'" + node.name + "' is the name of another node; give each its own");
      }
      names_.push_back(node.name);
      made_.nodes.push_back(
          {.mass = node.mass_kg, .position = node.position_m, .load = node.load_N});
    }
  }

  /// A node, else ground, else a coordinate; a device with one coordinate needs no more than its
  /// name.
  NetworkEnd end(const std::string& name, const std::string& place) {
    const auto node = std::find(names_.begin(), names_.end(), name);
    if (node != names_.end())
      return {NetworkEnd::At::node, static_cast<std::uint32_t>(node - names_.begin())};
    if (name == "ground") return {};
    const auto& devices = compilation_.spec.device_names;
    const std::string device = name.substr(0, name.find('.'));
    if (std::find(devices.begin(), devices.end(), device) == devices.end()) {
      refuse(place, unknown_name("coordinate or node", name, known_ends()));
      return {};
    }
    const auto coordinates = coordinates_named(compilation_, name, place);
    if (coordinates.size() == 1) return {NetworkEnd::At::coordinate, coordinates.front()};
    if (coordinates.size() > 1) {
      refuse(place, "device '" + name + "' has " + std::to_string(coordinates.size()) +
                        " coordinates; name one of them: " +
                        compilation_.spec.coordinate_names[coordinates.front()]);
    }
    sound_ = false;
    return {};
  }

  std::vector<std::string> known_ends() const {
    std::vector<std::string> known = compilation_.spec.coordinate_names;
    known.insert(known.end(), names_.begin(), names_.end());
    known.emplace_back("ground");
    return known;
  }

  void add_element(std::size_t i) {
    const NetworkElement& element = network_.elements[i];
    const std::string place = indexed(path_ + ".elements", i);
    const NetworkEnd a = end(element.between[0], place + ".between[0]");
    const NetworkEnd b = end(element.between[1], place + ".between[1]");
    if (sound_ && a.at == b.at && a.index == b.index)
      refuse(place + ".between", "both ends are the same; there is nothing between them");
    if (element.stiffness_N_m == 0 && element.damping_Ns_m == 0)
      refuse(place, "expected stiffness_N_m or damping_Ns_m above 0, found neither");
    made_.elements.push_back({.a = a,
                              .b = b,
                              .stiffness = element.stiffness_N_m,
                              .damping = element.damping_Ns_m,
                              .rest = element.rest_m});
  }

  void check_felt() {
    const auto is_coordinate = [](const build::NetworkElement& e) {
      return e.a.at == NetworkEnd::At::coordinate || e.b.at == NetworkEnd::At::coordinate;
    };
    if (std::any_of(made_.elements.begin(), made_.elements.end(), is_coordinate)) return;
    refuse(path_ + ".elements",
           "no element ends at a device's coordinate, so nobody would feel this network");
  }

  /// A joint without mass goes where its springs and dampers hold it; a chain of joints has to end
  /// at something that is somewhere.
  void check_determined() {
    std::vector<bool> held;
    for (const build::NetworkNode& node : made_.nodes) held.push_back(node.mass > 0);
    const auto is_held = [&](const NetworkEnd& end) {
      return end.at != NetworkEnd::At::node || held[end.index];
    };
    for (bool changed = true; changed;) {
      changed = false;
      for (const build::NetworkElement& element : made_.elements) {
        if (is_held(element.a) == is_held(element.b)) continue;
        held[is_held(element.a) ? element.b.index : element.a.index] = true;
        changed = true;
      }
    }
    const auto lost = std::find(held.begin(), held.end(), false);
    if (lost == held.end()) return;
    refuse(
        indexed(path_ + ".nodes", static_cast<std::size_t>(lost - held.begin())),
        "a node without mass_kg that no spring or damper holds is nowhere; give it a mass, or an "
        "element to something that has a place");
  }

  Compilation& compilation_;
  const Network& network_;
  const std::string& path_;
  std::vector<std::string> names_;
  build::Network made_;
  bool sound_ = true;
};

}  // namespace

void compile_network(Compilation& compilation, const Network& network, const std::string& path) {
  NetworkCompiler(compilation, network, path).compile();
}

}  // namespace hapticd::config
