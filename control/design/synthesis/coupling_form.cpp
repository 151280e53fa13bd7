#include "control/design/synthesis/coupling_form.h"

#include <Eigen/Dense>

#include "control/design/synthesis/balance.h"

namespace hapticd::synthesis {

using Eigen::Index;

namespace {

Index states_of(const FormBlock& block) {
  return block.spring_damper ? static_cast<Index>(block.coordinates.size()) : block.order;
}

bool reciprocal(const FormBlock& block) {
  return !block.spring_damper && block.coordinates.size() > 1 &&
         block.order < static_cast<Index>(block.coordinates.size());
}

/// Hands out variables: each call of fresh() is the next.
struct Places {
  FormVariables& into;
  Index first_state;
  const std::vector<Index>& coordinates;
  Index& next;
  Index count() const { return static_cast<Index>(coordinates.size()); }
  Index coordinate(Index k) const { return coordinates[static_cast<std::size_t>(k)]; }
  void a(Index v, Index k, Index l) { into.a.add(v, first_state + k, first_state + l, 1); }
  void b(Index v, Index k, Index l) { into.b.add(v, first_state + k, coordinate(l), 1); }
  void c(Index v, Index k, Index l) { into.c.add(v, coordinate(k), first_state + l, 1); }
  void d(Index v, Index k, Index l) { into.d.add(v, coordinate(k), coordinate(l), 1); }
};

void spring_damper_block(Places places) {
  for (Index l = 0; l < places.count(); ++l) {
    for (Index k = 0; k <= l; ++k) {
      const Index va = places.next++, vc = places.next++;
      places.a(va, k, l), places.b(va, k, l), places.c(vc, k, l), places.d(vc, k, l);
      if (k == l) continue;
      places.a(va, l, k), places.b(va, l, k), places.c(vc, l, k), places.d(vc, l, k);
    }
  }
}

void general_block(Places places, const FormBlock& block) {
  for (Index l = 0; l < block.order; ++l) {
    for (Index k = 0; k < (reciprocal(block) ? l + 1 : block.order); ++k) {
      places.a(places.next, k, l);
      if (reciprocal(block) && k != l) places.a(places.next, l, k);
      ++places.next;
    }
    for (Index k = 0; k < places.count(); ++k) {
      places.c(places.next, k, l);
      if (!reciprocal(block)) ++places.next;
      places.b(places.next++, l, k);
    }
  }
  for (Index l = 0; l < places.count(); ++l) {
    for (Index k = 0; k <= l; ++k) {
      places.d(places.next, k, l);
      if (k != l) places.d(places.next, l, k);
      ++places.next;
    }
  }
}

Matrix picked(const Matrix& m, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  Matrix part(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) {
      part(static_cast<Index>(i), static_cast<Index>(j)) = m(rows[i], columns[j]);
    }
  }
  return part;
}

/// V(1) made symmetric by the smallest change of B_V.
bool symmetric_at_rest(System& v) {
  v.D = check::symmetric_part(v.D);
  if (v.inputs() < 2) return true;
  const Matrix rest = check::at_rest(v);
  const Matrix skew = 0.5 * (rest - rest.transpose());
  if (skew.norm() <= 1e-14 * rest.norm()) return true;
  const Matrix resolvent = Matrix::Identity(v.states(), v.states()) - v.A;
  const Matrix reach = v.C * resolvent.inverse();
  v.B -= reach.completeOrthogonalDecomposition().solve(skew);
  const Matrix after = check::at_rest(v);
  return (after - after.transpose()).norm() <= 1e-12 * after.norm();
}

bool make_spring_damper(DesignedBlock& block, const Matrix& a, const Matrix& c, double unit,
                        double period_s) {
  if (!well_conditioned(c, 1e-14)) return false;
  const Matrix inverse = c.inverse(), one = Matrix::Identity(a.rows(), a.rows());
  block.stiffness = check::symmetric_part(unit / period_s * (one - a) * inverse);
  block.damping = check::symmetric_part(unit * a * inverse);
  block.V = spring_damper(block.stiffness, block.damping, period_s);
  return block.V.A.allFinite() && block.V.C.allFinite();
}

}  // namespace

Form decentralised(Index coordinates) {
  Form form;
  for (Index i = 0; i < coordinates; ++i) form.push_back({.coordinates = {i}});
  return form;
}

Form centralised(Index coordinates) {
  FormBlock all;
  for (Index i = 0; i < coordinates; ++i) all.coordinates.push_back(i);
  return {all};
}

bool covers(const Form& form, Index coordinates) {
  std::vector<int> named(static_cast<std::size_t>(coordinates), 0);
  for (const FormBlock& block : form) {
    if (block.order < 0) return false;
    for (std::size_t k = 0; k < block.coordinates.size(); ++k) {
      const Index i = block.coordinates[k];
      if (i < 0 || i >= coordinates || (k > 0 && i <= block.coordinates[k - 1])) return false;
      if (named[static_cast<std::size_t>(i)]++ > 0) return false;
    }
  }
  for (const int times : named) {
    if (times != 1) return false;
  }
  return true;
}

Index order(const Form& form) {
  Index n = 0;
  for (const FormBlock& block : form) n += states_of(block);
  return n;
}

FormVariables variables(Lmi& lmi, const Form& form, Index coordinates) {
  const Index n = order(form), m = coordinates;
  FormVariables v{Affine(n, n), Affine(n, m), Affine(m, n), Affine(m, m)};
  Index next = lmi.variables(), state = 0;
  for (const FormBlock& block : form) {
    const Places places{v, state, block.coordinates, next};
    if (block.spring_damper) {
      spring_damper_block(places);
    } else {
      general_block(places, block);
    }
    state += states_of(block);
  }
  lmi.reserve(next);
  return v;
}

std::optional<DesignedCoupling> coupling_at(const FormVariables& variables, const Vector& x,
                                            const Form& form, double unit, double period_s) {
  const Matrix a = variables.a.at(x), b = variables.b.at(x), c = variables.c.at(x),
               d = variables.d.at(x);
  const Index m = d.rows();
  DesignedCoupling coupling;
  coupling.stiffness = coupling.damping = Matrix::Zero(m, m);
  coupling.V = {Matrix::Zero(a.rows(), a.rows()), Matrix::Zero(a.rows(), m),
                Matrix::Zero(m, a.rows()), Matrix::Zero(m, m)};
  Index state = 0;
  for (const FormBlock& from : form) {
    DesignedBlock block{from.coordinates, from.spring_damper, {}, {}, {}};
    const std::vector<Index>& at = from.coordinates;
    std::vector<Index> states;
    for (Index k = 0; k < states_of(from); ++k) states.push_back(state + k);
    if (from.spring_damper) {
      if (!make_spring_damper(block, picked(a, states, states), picked(c, at, states), unit,
                              period_s)) {
        return std::nullopt;
      }
    } else {
      block.V = {picked(a, states, states), period_s * picked(b, states, at),
                 picked(c, at, states) / unit, period_s / unit * picked(d, at, at)};
      if (!symmetric_at_rest(block.V)) return std::nullopt;
    }
    for (std::size_t k = 0; k < at.size(); ++k) {
      const Index row = static_cast<Index>(k);
      for (std::size_t l = 0; l < at.size(); ++l) {
        const Index column = static_cast<Index>(l);
        coupling.V.D(at[k], at[l]) = block.V.D(row, column);
        if (!block.spring_damper) continue;
        coupling.stiffness(at[k], at[l]) = block.stiffness(row, column);
        coupling.damping(at[k], at[l]) = block.damping(row, column);
      }
      coupling.V.B.block(state, at[k], block.V.states(), 1) = block.V.B.col(row);
      coupling.V.C.block(at[k], state, 1, block.V.states()) = block.V.C.row(row);
    }
    coupling.V.A.block(state, state, block.V.states(), block.V.states()) = block.V.A;
    state += block.V.states();
    coupling.blocks.push_back(std::move(block));
  }
  return coupling;
}

}  // namespace hapticd::synthesis
