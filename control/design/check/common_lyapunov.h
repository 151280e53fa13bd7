// Quadratic Lyapunov functions z' P z for every loop of a box. With one for all: whatever the device, the hand, the
// latency and the share of contact are at a tick, and however they change from tick to tick,
//
//   |A z|_P < |z|_P,                                                                             (1)
//
// so that the loop is stable. This proves more than spectral radii can: those of frozen loops say
// nothing of a contact that opens and closes.
//
// The box is lumped first: a hand that is held rigidly adds its mass and damping to the device's. Then
// only the two rows of x and v depend on it (held_box.h), A = [G q; kept], and what they multiply on
// the contact, in an affine way. The box of (1/M, B, k, t) is cut into cells. In a cell
//
//   G = (hull of the affine part at the corners) + D G,  |D G| <= remainder, entry by entry,
//
// and A is a convex combination of A_c + E D F, c over corners and the ends of the contact's share,
// E D F = [D G q; 0], |D|_2 <= 1. Norms being convex, (1) holds for all of them if it holds for each c
// and every D, and that if for some lambda > 0
//
//   |A_c z + E u|_P^2 - |z|_P^2 < lambda (|u|^2 - |F z|^2)  for all z, u
//
// (u = D F z has |u| <= |F z|): a dissipation inequality, checked against its rounding by
// dissipation.h. A cell that fails is halved, until P fails for a loop of it alone or the cells are
// too many. So "holds" means the whole box, not its vertices.
//
// Where no P is common to all devices and hands there may be one for each: then what is proved is
// that every loop of the box is stable whose device and hand stay as they are, while latency and
// contact may still be others at every tick. That takes a list of P, of which some one has to do in
// every cell of (1/M, B, k), for all latencies and both ends of the contact's share.
//
// Within one tick everything but the latency is constant. The latency must stay within one period,
// n T .. (n + 1) T. Excluded: observers of mode `sensor`, whose reading depends on the device.
#pragma once
#include <functional>

#include "control/design/check/dissipation.h"
#include "control/design/check/loop_cases.h"

namespace hapticd::check {

/// The same box without a hand but for its spring: its mass and damping are the device's.
LoopBox lumped(const LoopBox& box);
/// N of sampled_loop.h for the loops of a box: P is of the order of transition(loop, one, N).
int remembered_in(const SampledLoop& loop, const LoopBox& box);
/// Why no P is looked for; empty: it may be.
std::string excluded(const SampledLoop& loop, const LoopBox& box);

struct CommonVerdict {
  bool holds = false;
  std::string why;
  std::size_t cells = 0;
  double margin = 0;     ///< least of (1) over all cells, in coordinates in which P = I
  bool refuted = false;  ///< P fails for the loop `at`; else the cells were too many
  LoopCase at;           ///< lumped; the middle of the cell where it ended
};
/// Cells that are looked at before an answer is "undecided", of a loop with four states; of larger ones as many as take
/// the same time. Less than a second, since a daemon that reloads waits for it; what is searched has to be provable
/// within the same.
inline constexpr std::size_t kMostCells = 3000;
/// Larger loops are not looked at.
inline constexpr int kMostStates = 24;
/// What is wrong with box or matrices for a proof; empty: nothing.
std::string unfit(const SampledLoop& loop, const LoopBox& box, const std::vector<Matrix>& P);

/// Whatever changes from tick to tick.
CommonVerdict proves_common(const SampledLoop& loop, const LoopBox& box, const Matrix& P,
                            std::size_t most_cells = kMostCells);
/// Devices and hands that do not change.
CommonVerdict proves_constant(const SampledLoop& loop, const LoopBox& box,
                              const std::vector<Matrix>& P, std::size_t most_cells = kMostCells);

/// A P for a smaller, lumped box, that would help; empty: none.
using FindP = std::function<Matrix(const LoopBox&)>;
/// The same, asking for more P on the way where those that it has do not do: for searches.
CommonVerdict completes_constant(const SampledLoop& loop, const LoopBox& box,
                                 std::vector<Matrix>& P, const FindP& find,
                                 std::size_t most_cells = kMostCells);

}  // namespace hapticd::check
