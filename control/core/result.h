// Errors as values, for set-up code. The loop never includes this header.
#pragma once
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace hapticd {

/// Exit codes of hapticd and hapticctl (sysexits.h where one fits), listed in the man pages.
enum class ExitCode : int {
  ok = 0,
  no = 1,  ///< the answer is no: not stable, check failed
  usage = 64,
  bad_data = 65,  ///< config data
  no_input = 66,
  unavailable = 69,    ///< device
  software = 70,       ///< a defect
  cannot_create = 73,  ///< output file
  try_again = 75,
  no_permission = 77,
};

/// One error for a person: what was expected, what was found, where, what to do.
struct Error {
  std::string text;
  ExitCode code = ExitCode::no;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(ExitCode code, std::string text) {
  return tl::unexpected<Error>(Error{std::move(text), code});
}

}  // namespace hapticd
