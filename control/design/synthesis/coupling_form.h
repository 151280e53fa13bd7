// What a designed coupling may look like: requirement (R2) of Bianchini, Orlandesi and Prattichizzo
// (2010). Blocks say which coordinates may share a spring; each block has an order of its own. One
// block per coordinate is their decentralised coupling, one for all the centralised one.
//
// Unknowns are (a, b, c, d), all of order one whatever the units, with `unit` N s/m:
//
//   A_V = a,  B_V = T b,  C_V = c / unit,  D_V = (T / unit) d;   V(z) = (T / unit) (d + c (zI - a)^-1 b)
//
// Springs and dampers are b = a, d = c (21), a and c symmetric; K and B of (22) are then made
// symmetric, since a and c need not commute. d is symmetric in every form. At rest V must be
// symmetric (a passive V-hat has a zero there whose derivative is V(1) - kappa): a block of several
// coordinates gets the b nearest to that, or, with fewer states than coordinates, is reciprocal
// from the start, a = a', b = c'.
#pragma once
#include <optional>
#include <vector>

#include "control/design/synthesis/lmi.h"
#include "control/design/synthesis/loop.h"

namespace hapticd::synthesis {

struct FormBlock {
  std::vector<Eigen::Index> coordinates;  ///< ascending
  bool spring_damper = true;
  Eigen::Index order = 0;  ///< of a general V(z); a spring-damper has one state a coordinate
};

/// Every coordinate is in exactly one block.
using Form = std::vector<FormBlock>;

Form decentralised(Eigen::Index coordinates);
Form centralised(Eigen::Index coordinates);
/// Is every one of m coordinates in exactly one block, orders >= 0?
bool covers(const Form& form, Eigen::Index coordinates);
/// States of all blocks.
Eigen::Index order(const Form& form);

struct FormVariables {
  Affine a, b, c, d;
};
FormVariables variables(Lmi& lmi, const Form& form, Eigen::Index coordinates);

struct DesignedBlock {
  std::vector<Eigen::Index> coordinates;
  bool spring_damper = true;
  Matrix stiffness, damping;  ///< of a spring-damper, symmetric, N/m and N s/m
  System V;                   ///< of the block's coordinates
};

struct DesignedCoupling {
  std::vector<DesignedBlock> blocks;
  System V;                   ///< of all coordinates, states in order of the blocks
  Matrix stiffness, damping;  ///< of all; zero rows where a block is a general V
};

/// The coupling at a solution; nothing where a block cannot be inverted or made symmetric.
std::optional<DesignedCoupling> coupling_at(const FormVariables& variables, const Vector& x,
                                            const Form& form, double unit, double period_s);

}  // namespace hapticd::synthesis
