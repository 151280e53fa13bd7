// With w = (y, x_M, x_S) the positions of contacts, masses and massless nodes:
//
//   M w'' + B w' + K w = g + (force from outside on the contacts)
//
// 1. Massless nodes. K_SS and B_SS are diagonalised together, x_S = V mu. A mode of springs alone
//    follows w at once, one of dampers alone has no place that matters; both leave no state. Each
//    other one is a lag of rate lambda: with V'B_SS V = 1, V'K_SS V = lambda and nu = mu + V'B_Sr w
//        nu' = -lambda nu - G'w + V'g,   force G nu on w.
// 2. Masses, in the modes theta of M and of the stiffness that is left once all lags have relaxed;
//    a mode without stiffness (masses that no spring holds) has a velocity and no place.
// 3. y' is taken out of the states: phi = theta' + (what the contacts' motion pushes at once).
//
// What each step removes is unobservable from the contacts, so the result is of E(s)'s own order,
// symmetries apart.
#include "control/build/network_modes.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "control/build/eigen.h"
#include "control/core/algebra.h"

namespace hapticd::build {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using At = NetworkEnd::At;

/// A mode whose lag is longer than 1e12 periods has no spring, one shorter than 1e-12 no damper:
/// exact zeros come out some 1e-15.
constexpr double kNone = 1e-12;

struct Modes {
  VectorXd values;  ///< ascending
  MatrixXd shapes;  ///< by columns
};

Modes modes(const MatrixXd& matrix) {
  if (matrix.size() == 0) return {VectorXd(0), MatrixXd(0, 0)};
  auto [values, vectors] = algebra::symmetric_eigen(matrix);
  return {std::move(values), std::move(vectors)};
}

/// How many of ascending values are at most `limit`.
Index count_up_to(const VectorXd& ascending, double limit) {
  return (ascending.array() <= limit).count();
}

struct Assembly {
  std::vector<std::uint32_t> coordinates;
  Index masses = 0, massless = 0;
  MatrixXd K, B;
  VectorXd g, mass, start;  ///< g, start: of all; mass: of x_M
  Index touched() const { return static_cast<Index>(coordinates.size()); }
  Index rest() const { return touched() + masses; }
};

std::vector<std::uint32_t> coordinates_of(const std::vector<Network>& networks) {
  std::set<std::uint32_t> found;
  for (const Network& network : networks)
    for (const NetworkElement& element : network.elements)
      for (const NetworkEnd end : {element.a, element.b})
        if (end.at == At::coordinate) found.insert(end.index);
  return {found.begin(), found.end()};
}

/// k (e_a - e_b)(e_a - e_b)', ground being no row.
void add_between(MatrixXd& matrix, Index a, Index b, double k) {
  if (a >= 0) matrix(a, a) += k;
  if (b >= 0) matrix(b, b) += k;
  if (a >= 0 && b >= 0) matrix(a, b) -= k, matrix(b, a) -= k;
}

void add(Assembly& all, const NetworkElement& element, Index a, Index b) {
  add_between(all.K, a, b, element.stiffness);
  add_between(all.B, a, b, element.damping);
  if (a >= 0) all.g(a) += element.stiffness * element.rest;
  if (b >= 0) all.g(b) -= element.stiffness * element.rest;
}

/// Rows of the nodes of each network: masses after the coordinates, massless nodes last.
std::vector<std::vector<Index>> number_nodes(const std::vector<Network>& networks, Assembly& all) {
  for (const Network& network : networks)
    for (const NetworkNode& node : network.nodes) ++(node.mass > 0 ? all.masses : all.massless);
  Index mass_row = all.touched(), joint_row = all.rest();
  std::vector<std::vector<Index>> rows;
  for (const Network& network : networks) {
    rows.emplace_back();
    for (const NetworkNode& node : network.nodes)
      rows.back().push_back(node.mass > 0 ? mass_row++ : joint_row++);
  }
  return rows;
}

Assembly assemble(const std::vector<Network>& networks) {
  Assembly all;
  all.coordinates = coordinates_of(networks);
  const auto rows = number_nodes(networks, all);
  const Index size = all.rest() + all.massless;
  all.K = all.B = MatrixXd::Zero(size, size);
  all.g = all.start = VectorXd::Zero(size);
  all.mass = VectorXd::Zero(all.masses);
  for (std::size_t n = 0; n < networks.size(); ++n) {
    const auto row = [&](NetworkEnd end) -> Index {
      if (end.at == At::ground) return -1;
      if (end.at == At::node) return rows[n][end.index];
      return std::ranges::lower_bound(all.coordinates, end.index) - all.coordinates.begin();
    };
    for (const NetworkElement& element : networks[n].elements)
      add(all, element, row(element.a), row(element.b));
    for (std::size_t i = 0; i < networks[n].nodes.size(); ++i) {
      const NetworkNode& node = networks[n].nodes[i];
      all.g(rows[n][i]) += node.load;
      all.start(rows[n][i]) = node.position;
      if (node.mass > 0) all.mass(rows[n][i] - all.touched()) = node.mass;
    }
  }
  return all;
}

/// Coordinates and masses, once the massless nodes are lags between them.
struct Reduced {
  MatrixXd K, B;  ///< K with every lag held
  VectorXd g;
  MatrixXd G;            ///< lag to force, by columns
  VectorXd rate, g_lag;  ///< per lag: lambda [1/s], V'g
  MatrixXd lag_gain;     ///< nu at the start: lag_gain w + lag_offset
  VectorXd lag_offset;
  MatrixXd relaxed() const { return K - G * rate.cwiseInverse().asDiagonal() * G.transpose(); }
};

/// Shapes of the massless nodes, by columns. springs' K springs = 1; the others to B likewise.
struct JointModes {
  MatrixXd springs, dampers, lags;  ///< of springs alone, of dampers alone, of both
  VectorXd rate;                    ///< per lag: lambda [1/s]
};

MatrixXd scaled(const MatrixXd& shapes, const MatrixXd& by) {
  const VectorXd squares = (shapes.transpose() * by * shapes).diagonal();
  return shapes * squares.cwiseSqrt().cwiseInverse().asDiagonal();
}

/// K and B/T are both diagonal in the modes of K relative to K + B/T, where they add up to 1.
JointModes joint_modes(const MatrixXd& K, const MatrixXd& B, double period_s) {
  const Eigen::LLT<MatrixXd> whole(K + B / period_s);
  const MatrixXd half = whole.matrixL().solve(K);
  const Modes found = modes(symmetric(whole.matrixL().solve(half.transpose())));
  const MatrixXd V = whole.matrixU().solve(found.shapes);
  const Index floating = count_up_to(found.values, kNone);
  const Index damped = count_up_to(found.values, 1 - kNone);
  JointModes result;
  result.springs = scaled(V.rightCols(V.cols() - damped), K);
  result.dampers = scaled(V.leftCols(floating), B);
  result.lags = scaled(V.middleCols(floating, damped - floating), B);
  result.rate = (result.lags.transpose() * K * result.lags).diagonal();
  return result;
}

Reduced without_massless(const Assembly& all, double period_s) {
  const Index r = all.rest(), s = all.massless;
  Reduced left;
  left.K = all.K.topLeftCorner(r, r);
  left.B = all.B.topLeftCorner(r, r);
  left.g = all.g.head(r);
  const MatrixXd K = all.K.rightCols(s), B = all.B.rightCols(s);
  const VectorXd g = all.g.tail(s);
  const JointModes joints =
      s > 0 ? joint_modes(K.bottomRows(s), B.bottomRows(s), period_s)
            : JointModes{MatrixXd(0, 0), MatrixXd(0, 0), MatrixXd(0, 0), VectorXd(0)};

  const MatrixXd pull = K.topRows(r) * joints.springs;
  left.K -= pull * pull.transpose();
  left.g -= pull * (joints.springs.transpose() * g);

  const MatrixXd drag = B.topRows(r) * joints.dampers;
  left.B -= drag * drag.transpose();
  left.g -= drag * (joints.dampers.transpose() * g);

  const MatrixXd Bl = B.topRows(r) * joints.lags, Kl = K.topRows(r) * joints.lags;
  left.rate = joints.rate;
  left.G = Kl - Bl * left.rate.asDiagonal();
  left.B -= Bl * Bl.transpose();
  left.K -= Kl * Bl.transpose() + Bl * left.G.transpose();
  left.g_lag = joints.lags.transpose() * g;
  left.g -= Bl * left.g_lag;
  left.lag_gain = Bl.transpose();
  left.lag_offset = joints.lags.transpose() * B.bottomRows(s) * all.start.tail(s);
  return left;
}

/// R'R = damping, with the fewest rows. `scale`: the largest damping.
MatrixXd root(const MatrixXd& damping, double scale) {
  const Modes found = modes(symmetric(damping));
  const Index rank = damping.rows() - count_up_to(found.values, kNone * scale);
  return found.values.tail(rank).cwiseSqrt().asDiagonal() *
         found.shapes.rightCols(rank).transpose();
}

/// x_M = P theta with P'M P = 1; the first `free` of them have no stiffness.
struct MassModes {
  MatrixXd P, inverse;
  VectorXd stiffness;  ///< omega^2 [1/s^2]
  Index free = 0;
};

/// `scale`: omega^2 of the stiffest springs, what rounding is measured by.
MassModes mass_modes(const MatrixXd& stiffness, const VectorXd& mass, double scale) {
  const VectorXd half = mass.cwiseSqrt(), back = half.cwiseInverse();
  const Modes found = modes(symmetric(back.asDiagonal() * stiffness * back.asDiagonal()));
  return {.P = back.asDiagonal() * found.shapes,
          .inverse = found.shapes.transpose() * half.asDiagonal(),
          .stiffness = found.values,
          .free = count_up_to(found.values, 1e-13 * scale)};
}

/// What couples contacts (y), mass modes (theta) and lags (nu), by rows and columns.
struct Links {
  MassModes mass;
  MatrixXd relaxed;     ///< y - y and y - x_M: stiffness once the lags have relaxed
  MatrixXd Km, Bm, Bd;  ///< y - theta: stiffness, damping; theta - theta: damping
  MatrixXd Gy, Gm;      ///< y - nu, theta - nu
  MatrixXd follow;      ///< where the lags relax to: lambda^-1 Gm'
};

Links links_of(const Assembly& all, const Reduced& left) {
  const Index m = all.touched(), n = all.masses;
  Links to;
  to.relaxed = left.relaxed();
  const double stiffest =
      n > 0 ? all.K.diagonal().segment(m, n).cwiseQuotient(all.mass).maxCoeff() : 0;
  to.mass = mass_modes(to.relaxed.bottomRightCorner(n, n), all.mass, stiffest);
  const MatrixXd& P = to.mass.P;
  to.Km = left.K.topRightCorner(m, n) * P;
  to.Bm = left.B.topRightCorner(m, n) * P;
  to.Bd = P.transpose() * left.B.bottomRightCorner(n, n) * P;
  to.Gy = left.G.topRows(m);
  to.Gm = P.transpose() * left.G.bottomRows(n);
  to.follow = left.rate.cwiseInverse().asDiagonal() * to.Gm.transpose();
  return to;
}

/// xi with all at rest.
void set_start(NetworkModes& result, const Assembly& all, const Reduced& left, const Links& to) {
  const Index m = all.touched(), n = all.masses, held = n - to.mass.free;
  const VectorXd at = all.start.segment(m, n), theta = to.mass.inverse * at;
  result.start_gain.resize(result.A.rows(), m);
  result.start_gain << MatrixXd::Zero(held, m), to.Bm.transpose(), left.lag_gain.leftCols(m);
  result.start_offset.resize(result.A.rows());
  result.start_offset << theta.tail(held), VectorXd::Zero(n),
      left.lag_offset + left.lag_gain.rightCols(n) * at + to.follow * theta;
}

/// Step 3: states (theta of the modes with stiffness, phi, nu + follow theta).
NetworkModes with_masses(const Assembly& all, const Reduced& left) {
  const Links to = links_of(all, left);
  const auto& [mass, relaxed, Km, Bm, Bd, Gy, Gm, follow] = to;
  const Index m = all.touched(), n = all.masses, l = left.rate.size();
  const Index held = n - mass.free, size = held + n + l;

  NetworkModes result;
  result.coordinates = all.coordinates;
  MatrixXd& A = result.A = MatrixXd::Zero(size, size);
  A.block(0, held, held, n) = MatrixXd::Identity(n, n).bottomRows(held);
  A.block(held + mass.free, 0, held, held) = -MatrixXd(mass.stiffness.tail(held).asDiagonal());
  A.block(held, held, n, n) = -Bd;
  A.block(held, held + n, n, l) = -Gm;
  A.block(held + n, held, l, n) = follow;
  A.bottomRightCorner(l, l) = -MatrixXd(left.rate.asDiagonal());

  result.B.resize(size, m);
  result.B << -Bm.rightCols(held).transpose(), Bd * Bm.transpose() - Km.transpose(),
      -Gy.transpose() - follow * Bm.transpose();
  result.C.resize(m, size);
  result.C << (relaxed.topRightCorner(m, n) * mass.P).rightCols(held), Bm, Gy;
  result.D = symmetric(left.K.topLeftCorner(m, m) - Bm * Bm.transpose());
  result.R = root(left.B.topLeftCorner(m, m), all.B.diagonal().cwiseAbs().maxCoeff());
  result.push = left.g.head(m);
  result.drift.resize(size);
  result.drift << VectorXd::Zero(held), mass.P.transpose() * left.g.tail(n), left.g_lag;
  set_start(result, all, left, to);
  return result;
}

}  // namespace

NetworkModes network_modes(const std::vector<Network>& networks, double period_s) {
  const Assembly all = assemble(networks);
  return with_masses(all, without_massless(all, period_s));
}

}  // namespace hapticd::build
