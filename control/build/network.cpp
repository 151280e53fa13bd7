#include "control/build/network.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

#include "control/build/ties.h"

namespace hapticd::build {
namespace {

using At = NetworkEnd::At;

bool acts(const NetworkElement& element) {
  return element.stiffness != 0 || element.damping != 0;
}

/// Nodes first, then coordinates; ground is no end of a tie.
std::size_t place(const Network& network, NetworkEnd end) {
  return end.index + (end.at == At::coordinate ? network.nodes.size() : 0);
}

std::size_t places(const Network& network) {
  std::size_t result = network.nodes.size();
  for (const NetworkElement& element : network.elements)
    for (const NetworkEnd end : {element.a, element.b})
      if (end.at == At::coordinate) result = std::max(result, place(network, end) + 1);
  return result;
}

Ties tied(const Network& network) {
  Ties ties(places(network));
  for (const NetworkElement& element : network.elements)
    if (acts(element) && element.a.at != At::ground && element.b.at != At::ground)
      ties.tie(place(network, element.a), place(network, element.b));
  return ties;
}

bool all_finite(std::initializer_list<double> values) {
  for (const double value : values)
    if (!std::isfinite(value)) return false;
  return true;
}

std::string node_problem(const NetworkNode& node) {
  if (!all_finite({node.mass, node.position, node.load})) return "a figure is not finite";
  if (node.mass < 0) return "its mass is negative; expected 0 or more [kg]";
  return {};
}

std::string end_problem(NetworkEnd end, const Network& network, std::size_t coordinates) {
  if (end.at == At::coordinate && end.index >= coordinates)
    return "it ends at coordinate " + std::to_string(end.index) + ", but there are " +
           std::to_string(coordinates);
  if (end.at == At::node && end.index >= network.nodes.size())
    return "it ends at node " + std::to_string(end.index) + ", but there are " +
           std::to_string(network.nodes.size());
  return {};
}

std::string element_problem(const NetworkElement& element, const Network& network,
                            std::size_t coordinates) {
  if (!all_finite({element.stiffness, element.damping, element.rest}))
    return "a figure is not finite";
  if (element.stiffness < 0) return "its stiffness is negative; expected 0 or more [N/m]";
  if (element.damping < 0) return "its damping is negative; expected 0 or more [N s/m]";
  if (element.a.at == element.b.at &&
      (element.a.at == At::ground || element.a.index == element.b.index))
    return "it begins where it ends; expected two different ends";
  std::string found = end_problem(element.a, network, coordinates);
  return found.empty() ? end_problem(element.b, network, coordinates) : found;
}

/// Of the nodes whose place nothing determines: no mass, and no chain to anything that has a place.
std::string loose_problem(const Network& network) {
  const Ties ties = tied(network);
  std::vector<bool> held(places(network));
  for (std::size_t i = 0; i < held.size(); ++i)
    if (i >= network.nodes.size() || network.nodes[i].mass > 0) held[ties.first(i)] = true;
  for (const NetworkElement& element : network.elements) {
    if (!acts(element)) continue;
    if (element.a.at == At::ground) held[ties.first(place(network, element.b))] = true;
    if (element.b.at == At::ground) held[ties.first(place(network, element.a))] = true;
  }
  for (std::size_t i = 0; i < network.nodes.size(); ++i)
    if (!held[ties.first(i)])
      return "node " + std::to_string(i) +
             " has no mass, and no spring or damper leads from it to a contact, to ground or to a "
             "node with mass, so nothing says where it is: connect it or give it a mass";
  return {};
}

std::string problem(const Network& network, std::size_t coordinates) {
  for (std::size_t i = 0; i < network.nodes.size(); ++i)
    if (const std::string found = node_problem(network.nodes[i]); !found.empty())
      return "node " + std::to_string(i) + ": " + found;
  for (std::size_t i = 0; i < network.elements.size(); ++i)
    if (const std::string found = element_problem(network.elements[i], network, coordinates);
        !found.empty())
      return "element " + std::to_string(i) + ": " + found;
  return loose_problem(network);
}

}  // namespace

std::string problem(const std::vector<Network>& networks, std::size_t coordinates) {
  for (std::size_t i = 0; i < networks.size(); ++i)
    if (const std::string found = problem(networks[i], coordinates); !found.empty())
      return "network " + std::to_string(i) + ": " + found;
  return {};
}

std::vector<Network> separate(const Network& network) {
  const Ties ties = tied(network);
  std::map<std::size_t, Network> parts;
  for (const NetworkElement& element : network.elements)
    for (const NetworkEnd end : {element.a, element.b})
      if (acts(element) && end.at == At::coordinate) parts[ties.first(place(network, end))];
  std::vector<std::uint32_t> renamed(network.nodes.size());
  for (std::size_t i = 0; i < network.nodes.size(); ++i) {
    const auto part = parts.find(ties.first(i));
    if (part == parts.end()) continue;
    renamed[i] = static_cast<std::uint32_t>(part->second.nodes.size());
    part->second.nodes.push_back(network.nodes[i]);
  }
  for (NetworkElement element : network.elements) {
    const NetworkEnd held = element.a.at == At::ground ? element.b : element.a;
    const auto part = parts.find(ties.first(place(network, held)));
    if (!acts(element) || part == parts.end()) continue;
    for (NetworkEnd* end : {&element.a, &element.b})
      if (end->at == At::node) end->index = renamed[end->index];
    part->second.elements.push_back(element);
  }
  std::vector<Network> result;
  for (auto& [first, part] : parts) result.push_back(std::move(part));
  return result;
}

std::vector<double> LinearScene::first_states(const std::vector<double>& y) const {
  std::vector<double> result = start_offset;
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t j = 0; j < y.size(); ++j) result[i] += start_gain(i, j) * y[j];
  return result;
}

}  // namespace hapticd::build
