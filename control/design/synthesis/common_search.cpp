#include "control/design/synthesis/common_search.h"

#include <Eigen/Dense>
#include <algorithm>

#include "control/design/check/balance.h"
#include "control/design/synthesis/balance.h"
#include "control/design/synthesis/lmi.h"

namespace hapticd::synthesis {
namespace {

using check::LoopBox;
using check::LoopCase;

/// y = S z.
Matrix contracting(const Matrix& a) {
  const check::Vector d = check::balance(a);
  const Matrix balanced = d.cwiseInverse().asDiagonal() * a * d.asDiagonal();
  const Matrix P = discrete_lyapunov(balanced.transpose(), Matrix::Identity(a.rows(), a.rows()));
  return Matrix(Eigen::LLT<Matrix>(P).matrixL()).transpose() * d.cwiseInverse().asDiagonal();
}

/// Empty where there is none.
Matrix solved(const std::vector<Matrix>& loops) {
  const Eigen::Index n = loops.front().rows();
  Lmi lmi;
  const Affine P = lmi.symmetric(n);
  for (const Matrix& a : loops) lmi.at_least(P - a.transpose() * P * a, 1);
  lmi.minimise(Matrix::Identity(n, n), P);
  const SdpAnswer answer = lmi.solve({.gap = 1e-4, .bound = 1e9});
  if (answer.x.size() == 0 || !(slack(lmi.problem(), answer.x) > -0.5)) return {};
  return P.at(answer.x);
}

/// Loops of one box, in the coordinates of one of them.
class Program {
 public:
  Program(const check::SampledLoop& loop, const LoopBox& box)
      : loop_(loop), box_(box), remembered_(check::remembered_in(loop, box)) {
    const double first = (remembered_ - 1) * loop.period_s;
    // Never a whole period after the first tick: that loop has a state more.
    latest_ = std::max(box.latency_s.low,
                       std::min(box.latency_s.high, first + loop.period_s * (1 - 1e-9)));
  }

  /// Starts anew around one loop; false: it is not stable.
  bool start(LoopCase one) {
    one.contact = box_.contact.high;
    one.latency_s = 0.5 * (box_.latency_s.low + latest_);
    scale_ = contracting(check::transition(loop_, one, remembered_));
    loops_.clear();
    return scale_.allFinite();
  }
  void add(LoopCase one) {
    one.latency_s = std::min(one.latency_s, latest_);
    const Matrix a = scale_ * check::transition(loop_, one, remembered_);
    loops_.push_back(scale_.transpose().partialPivLu().solve(a.transpose()).transpose());
  }
  /// Empty where there is none.
  Matrix solve() const {
    const Matrix scaled = solved(loops_);
    if (scaled.size() == 0) return {};
    return check::symmetric_part(scale_.transpose() * scaled * scale_);
  }
  std::size_t size() const { return loops_.size(); }

 private:
  const check::SampledLoop& loop_;
  const LoopBox box_;
  int remembered_;
  double latest_ = 0;
  Matrix scale_;
  std::vector<Matrix> loops_;
};

LoopCase middle_of(const LoopBox& box) {
  const std::vector<LoopCase> thirds = check::cases_of(box, 3);
  return thirds[thirds.size() / 2];
}

}  // namespace

CommonAnswer find_common(const check::SampledLoop& loop, const LoopBox& box) {
  constexpr int kRounds = 12;
  CommonAnswer answer;
  answer.why = check::excluded(loop, box);
  if (!answer.why.empty()) return answer;
  const LoopBox whole = check::lumped(box);
  Program program(loop, whole);
  if (!program.start(middle_of(whole))) {
    answer.why = "the loop in the middle of the box is not stable";
    return answer;
  }
  for (const LoopCase& one : check::cases_of(whole, 2)) program.add(one);
  for (int round = 0; round < kRounds; ++round) {
    const Matrix P = program.solve();
    if (P.size() == 0) {
      answer.why = "no quadratic Lyapunov function is common to " + std::to_string(program.size()) +
                   " loops of the box";
      return answer;
    }
    answer.verdict = check::proves_common(loop, box, P);
    answer.why = answer.verdict.why;
    if (answer.verdict.holds) answer.P = {P};
    if (answer.verdict.holds || !answer.verdict.refuted) return answer;
    for (const double contact : {box.contact.low, box.contact.high}) {
      LoopCase one = answer.verdict.at;
      one.contact = contact;
      program.add(one);
    }
  }
  return answer;
}

CommonAnswer find_constant(const check::SampledLoop& loop, const LoopBox& box, std::size_t most) {
  CommonAnswer answer;
  answer.why = check::excluded(loop, box);
  if (!answer.why.empty()) return answer;
  const auto find = [&](const LoopBox& cell) {
    Program program(loop, cell);
    if (answer.P.size() >= most || !program.start(middle_of(cell))) return Matrix();
    for (const LoopCase& one : check::cases_of(cell, 2)) program.add(one);
    return program.solve();
  };
  answer.verdict = check::completes_constant(loop, box, answer.P, find);
  answer.why = answer.verdict.why;
  if (answer.P.size() >= most && !answer.verdict.holds) {
    answer.why =
        "undecided: " + std::to_string(most) + " quadratic Lyapunov functions are not enough";
    answer.verdict.refuted = false;
  }
  if (!answer.verdict.holds) answer.P.clear();
  return answer;
}

}  // namespace hapticd::synthesis
