#include <dlfcn.h>

#include "control/design/synthesis/sdp_backends.h"

namespace hapticd::synthesis {

namespace {

// Debian's BLAS is an alternative that is chosen when the program starts: asked for by name, so
// that nothing is linked to OpenBLAS where another one serves.
template <typename Function>
Function* of_openblas(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

}  // namespace

OneBlasThread::OneBlasThread() {
  auto* get = of_openblas<int()>("openblas_get_num_threads");
  auto* set = of_openblas<void(int)>("openblas_set_num_threads");
  if (get == nullptr || set == nullptr) return;
  before_ = get();
  set(1);
}

OneBlasThread::~OneBlasThread() {
  if (before_ > 0) of_openblas<void(int)>("openblas_set_num_threads")(before_);
}

}  // namespace hapticd::synthesis
