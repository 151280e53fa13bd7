// How a designed coupling is proved; apart from the certificate's matrices, so that a config needs
// no linear algebra.
#pragma once
#include <cstdint>

namespace hapticd::check {

enum class CertificateKind : std::uint8_t {
  passive_closed_form,  ///< Theorems A, A', B for springs and dampers: needs no matrices
  passive_lmi,          ///< a scene or a coupling for which no closed form is known (Theorem 3)
  sampled_exact,        ///< this linear scene and no other
};

}  // namespace hapticd::check
