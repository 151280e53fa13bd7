// Networks of masses, springs and dampers between contact coordinates, nodes and ground, and what
// they are to the loop: E(z) from the displacement of the contacts to the force on the network.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace hapticd::build {

/// By rows. No Eigen here: every test would compile it.
struct Matrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
  double& operator()(std::size_t i, std::size_t j) { return values[i * columns + j]; }
  double operator()(std::size_t i, std::size_t j) const { return values[i * columns + j]; }
};

/// One end of an element: a coordinate of a contact (index into the contacts' coordinates of all
/// devices), a node of the network, or ground.
struct NetworkEnd {
  enum class At : std::uint8_t { ground, coordinate, node } at = At::ground;
  std::uint32_t index = 0;
};

/// Force between the ends: stiffness ((x_a - x_b) - rest) + damping (v_a - v_b).
struct NetworkElement {
  NetworkEnd a, b;
  double stiffness = 0;  ///< N/m, >= 0
  double damping = 0;    ///< N s/m, >= 0
  double rest = 0;       ///< m: x_a - x_b where the spring is slack
};

struct NetworkNode {
  double mass = 0;      ///< kg, >= 0; 0: a massless joint, which must have a spring or damper
  double position = 0;  ///< m, at the start, at rest; of no account for a joint of springs alone
  double load = 0;      ///< N: constant force on it
};

struct Network {
  std::vector<NetworkNode> nodes;
  std::vector<NetworkElement> elements;
};

/// What is wrong with the networks, for people; empty: sound. Names them by index. `coordinates`:
/// how many there are of all contacts.
std::string problem(const std::vector<Network>& networks, std::size_t coordinates);

/// The parts that no element ties together. A part that touches no coordinate is left out: none of
/// its force ever reaches a contact.
std::vector<Network> separate(const Network& network);

/// How a network's differential equation becomes a difference equation. Backward Euler keeps
/// masses, springs and dampers passive at any step (each tick is a descent step of its energy) and
/// is what the theorems are about; the others are for comparison (tests/bench/pareto).
enum class Integrator : std::uint8_t { backward_euler, trapezoid, exact };

/// f = C eta + D y - push (force on the network), eta' = A eta + B y + drift; m =
/// coordinates.size(), p states: two per mass (one where no spring holds it), one per damper that
/// acts through a spring on a massless node, one per damper that a contact moves directly. That is
/// the order of E(z) but for modes that symmetry hides (two equal branches side by side).
///
/// Backward Euler: D is symmetric and >= 0 (integrators.cpp).
struct LinearScene {
  std::vector<std::uint32_t> coordinates;  ///< that it touches, ascending
  Matrix A, B, C, D;
  std::vector<double> push, drift;
  /// eta for nodes at their start positions and at rest, contacts at `y` and at rest.
  std::vector<double> first_states(const std::vector<double>& y) const;
  Matrix start_gain;  ///< p x m: share of y in the first states
  std::vector<double> start_offset;
};

/// E of all networks together. `substeps` >= 1 divides the period for the integrators that are not
/// exact. Throws std::invalid_argument with problem()'s words.
LinearScene linear_scene(const std::vector<Network>& networks, double period_s,
                         Integrator integrator, std::size_t substeps);

}  // namespace hapticd::build
