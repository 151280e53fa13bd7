// What each key of a coupling and of a linear system is; part of config/describe.h.
#pragma once
#include "config/key.h"
#include "config/schema_coupling.h"
#include "control/core/capacity.h"

namespace hapticd::config {

/// States of one linear system that somebody may write down.
inline constexpr std::size_t kMaxStates = 64;
/// Rows of a matrix of a certificate.
inline constexpr std::size_t kMaxCertificateOrder = 256;

template <class V>
void describe(V& v, StateSpace& s) {
  const auto matrix = [&](const char* name, Rows& rows, const char* about, bool needed) {
    const Key key{.about = about, .min = -1e12, .max = 1e12, .max_items = kMaxStates};
    needed ? v.required(name, rows, key) : v.optional(name, rows, key);
  };
  matrix("A", s.A, "states to states, by rows; empty: no memory", false);
  matrix("B", s.B, "inputs to states", false);
  matrix("C", s.C, "states to outputs", false);
  matrix("D", s.D, "inputs to outputs", true);
}

/// `contacts` of a block of the coupling, or of a hand.
template <class V>
void describe_contacts(V& v, std::vector<std::string>& contacts) {
  v.required("contacts", contacts,
             {.about = "over which coordinates: left.x, or left for all that device left has, in "
                       "the order x, y, z; rows and columns of matrices are in this order",
              .form = TextForm::coordinate,
              .min_items = 1,
              .max_items = kMaxCoordinates});
}

template <class V>
void describe(V& v, CouplingBlock& s) {
  describe_contacts(v, s.contacts);
  v.optional("stiffness_N_m", s.stiffness_N_m,
             {.about = "K: for all alike, for each, or a positive definite matrix; this or "
                       "state_space",
              .min = -1e7,
              .max = 1e7,
              .unit = "N/m",
              .min_items = 1,
              .max_items = kMaxCoordinates});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "B: likewise; may be slightly negative as long as K + 2 B / period is "
                       "positive definite",
              .min = -1e5,
              .max = 1e5,
              .unit = "N s/m",
              .min_items = 1,
              .max_items = kMaxCoordinates});
  v.optional("state_space", s.state_space,
             {.about = "general V(z), force in N to stretch in m, one step a period, D symmetric "
                       "and positive definite; null: a spring and a damper"});
}

template <class V>
void describe(V& v, Solver& s) {
  v.optional("max_sweeps", s.max_sweeps,
             {.about = "over all bodies that are touched, in one tick; fewer cost accuracy",
              .min = 1,
              .max = 10'000});
  v.optional(
      "tolerance_N", s.tolerance_N,
      {.about = "sweeps end when no force changes by more", .min = 0, .max = 1, .unit = "N"});
}

template <class V>
void describe_solver(V& v, Solver& solver) {
  v.optional("solver", solver, {.about = "when to stop looking for the forces of one tick"});
}

inline constexpr Key kBlocks{
    .about =
        "springs and dampers, or V(z), over disjoint sets of coordinates; coordinates that no "
        "block names feel the scene directly",
    .max_items = kMaxCoordinates};

template <class V>
void describe(V& v, AssumedDevice& s) {
  v.required("name", s.name, {.about = "of the device", .form = TextForm::name});
  v.required("latency_s", s.latency_s,
             {.about = "longest latency", .min = 0, .max = 1, .unit = "s"});
  v.required("min_damping", s.min_damping,
             {.about = "least damping of each axis, N s/m or N m s/rad",
              .min = 0,
              .max = 1e6,
              .max_items = kMaxAxesPerDevice});
  v.optional("estimators", s.estimators,
             {.about = "of the velocity of each axis", .max_items = kMaxAxesPerDevice});
  v.optional("observers", s.observers, {.about = "of each axis", .max_items = kMaxAxesPerDevice});
}

template <class V>
void describe(V& v, Assumed& s) {
  v.required("rate_Hz", s.rate_Hz, {.about = "of the loop", .min = 100, .max = 8000, .unit = "Hz"});
  v.required("scene", s.scene, {.about = "digest of the scene"});
  v.required("devices", s.devices,
             {.about = "all devices of the config", .min_items = 1, .max_items = kMaxDevices});
}

template <class V>
void describe(V& v, CouplingCertificate& s) {
  v.required("kind", s.kind, {.about = "how it is proved"});
  v.optional("damping_share", s.damping_share,
             {.about = "share of the device's damping that the proof may use",
              .min = 0,
              .max = 0.999999,
              .above_min = true});
  const auto matrix = [&](const char* name, Rows& rows, const char* about) {
    v.optional(name, rows,
               {.about = about, .min = -1e300, .max = 1e300, .max_items = kMaxCertificateOrder});
  };
  matrix("P_scene", s.P_scene, "proves the level of a scene that is not passive by construction");
  matrix("Phi_scene", s.Phi_scene, "that level: the scene plus this is passive");
  matrix("P_coupling", s.P_coupling, "proves the level of a general V(z)");
  matrix("Delta_coupling", s.Delta_coupling, "that level");
  matrix("P", s.P, "proves coupling and this one scene passive as they are sampled");
}

/// What only `hapticctl design` writes.
template <class V>
void describe_designed(V& v, CouplingFile& s) {
  v.optional("assumed", s.assumed, {.about = "what it was designed for; null: not designed"});
  v.optional("certificate", s.certificate,
             {.about = "what proves it, checked at every load; null: closed forms alone"});
  v.optional("digest", s.digest,
             {.about = "of the lines above: names an edit by hand; null: not designed"});
}

template <class V>
void describe(V& v, CouplingFile& s) {
  v.required("blocks", s.blocks, kBlocks);
  describe_solver(v, s.solver);
  describe_designed(v, s);
}

template <class V>
void describe(V& v, Coupling& s) {
  v.optional("file", s.file,
             {.about = "the file that has blocks and solver; null: they stand here"});
  v.optional("blocks", s.blocks, kBlocks);
  describe_solver(v, s.solver);
}

}  // namespace hapticd::config
