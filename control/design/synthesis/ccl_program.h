// The semidefinite program of one step of cone complementarity linearisation (ccl.h).
#pragma once
#include <optional>
#include <vector>

#include "control/design/synthesis/ccl.h"
#include "control/design/synthesis/lmi.h"

namespace hapticd::synthesis {

/// w z -> I is wanted, [w, I; I, z] > 0 demanded.
struct Complementary {
  Affine w, z;
  Matrix w_last, z_last;
};

class CclProgram {
 public:
  /// Nothing but the loop's own inequalities. `problem` says why there is no program.
  CclProgram(const HapticLoop& loop, const Form& form, const CclOptions& options);
  const std::string& problem() const noexcept { return problem_; }

  Lmi& lmi() noexcept { return lmi_; }
  const FormVariables& form() const noexcept { return form_; }
  double unit() const noexcept { return unit_; }
  void complementary(const Affine& w, const Affine& z);
  /// a >= shift I.
  void at_least(const Affine& a) { lmi_.at_least(a, options_.shift); }

  /// One step; `cost` is added to the traces. The answer's objective is that of the traces alone.
  SdpAnswer step(const Affine* cost = nullptr, double weight = 0);
  double complementarity() const noexcept { return complementarity_; }

 private:
  void scene(const HapticLoop& loop, const Affine& phi, const Affine& delta);
  void coupling(const HapticLoop& loop, const Affine& delta, const Pattern& levels,
                const Pattern& states);

  CclOptions options_;
  Lmi lmi_;
  FormVariables form_;
  double unit_ = 1;
  double complementarity_ = 0;
  std::vector<Complementary> pairs_;
  std::string problem_;
};

/// Of a verified coupling, the smaller the better; infinity: not wanted.
using Merit = std::function<double(const DesignedCoupling&)>;

/// Takes the iterate into `best` where Theorem 3 proves it and its merit is less than what there is;
/// without a merit the first one stays.
bool consider(const HapticLoop& loop, const Merit& merit, DesignedCoupling coupling,
              CclDesign& best);

}  // namespace hapticd::synthesis
