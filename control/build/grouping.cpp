#include "control/build/grouping.h"

#include <map>

#include "control/build/ties.h"

namespace hapticd::build {
namespace {

Matrix part_of(const Matrix& matrix, const std::vector<std::size_t>& rows) {
  Matrix part{.rows = rows.size(), .columns = rows.size(), .values = {}};
  for (const std::size_t i : rows)
    for (const std::size_t j : rows) part.values.push_back(matrix(i, j));
  return part;
}

bool is_tied(const CouplingBlock& block, std::size_t i, std::size_t j) {
  return block.state_space || block.stiffness(i, j) != 0 || block.damping(i, j) != 0;
}

/// The parts of a block that share no spring and no damper.
std::vector<CouplingBlock> separate(const CouplingBlock& block) {
  const std::size_t m = block.coordinates.size();
  Ties ties(m);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (is_tied(block, i, j)) ties.tie(i, j);
  std::map<std::size_t, std::vector<std::size_t>> rows;
  for (std::size_t i = 0; i < m; ++i) rows[ties.first(i)].push_back(i);
  if (rows.size() == 1) return {block};
  std::vector<CouplingBlock> parts;
  for (const auto& [first, of_part] : rows) {
    CouplingBlock part;
    for (const std::size_t i : of_part) part.coordinates.push_back(block.coordinates[i]);
    part.stiffness = part_of(block.stiffness, of_part);
    part.damping = part_of(block.damping, of_part);
    parts.push_back(part);
  }
  return parts;
}

std::vector<std::uint32_t> coordinates_of(const CouplingBlock& block) {
  return block.coordinates;
}

std::vector<std::uint32_t> coordinates_of(const Network& network) {
  std::vector<std::uint32_t> found;
  for (const NetworkElement& element : network.elements)
    for (const NetworkEnd end : {element.a, element.b})
      if (end.at == NetworkEnd::At::coordinate) found.push_back(end.index);
  return found;
}

template <typename Whole>
std::vector<Whole> all_parts(const std::vector<Whole>& wholes) {
  std::vector<Whole> parts;
  for (const Whole& whole : wholes)
    for (Whole& part : separate(whole)) parts.push_back(std::move(part));
  return parts;
}

std::size_t contact_of(const GroupsSpec& spec, std::uint32_t coordinate) {
  std::size_t contact = 0;
  while (coordinate - spec.contacts[contact].first_coordinate >= spec.contacts[contact].coordinates)
    ++contact;
  return contact;
}

}  // namespace

std::vector<TiedContacts> tied_contacts(const GroupsSpec& spec) {
  const std::vector<CouplingBlock> blocks = all_parts(spec.blocks);
  const std::vector<Network> networks = all_parts(spec.networks);
  Ties ties(spec.contacts.size());
  std::vector<bool> named(spec.contacts.size());
  const auto first_contact = [&](const auto& part) {
    return contact_of(spec, coordinates_of(part).front());
  };
  const auto join = [&](const auto& part) {
    for (const std::uint32_t coordinate : coordinates_of(part)) {
      ties.tie(contact_of(spec, coordinate), first_contact(part));
      named[contact_of(spec, coordinate)] = true;
    }
  };
  for (const CouplingBlock& block : blocks) join(block);
  for (const Network& network : networks) join(network);

  std::map<std::size_t, TiedContacts> groups;
  for (std::size_t c = 0; c < named.size(); ++c)
    if (named[c]) groups[ties.first(c)].contacts.push_back(static_cast<std::uint16_t>(c));
  for (const CouplingBlock& block : blocks)
    groups[ties.first(first_contact(block))].blocks.push_back(block);
  for (const Network& network : networks)
    groups[ties.first(first_contact(network))].networks.push_back(network);
  std::vector<TiedContacts> result;
  for (auto& [first, group] : groups) result.push_back(std::move(group));
  return result;
}

}  // namespace hapticd::build
