#include "shared/base/kernels.h"

#include <vector>

namespace spoor {

extern const Kernels kKernels_baseline;
#ifdef SPOOR_X86_KERNELS
extern const Kernels kKernels_avx2;
extern const Kernels kKernels_avx512;
#endif

namespace {

std::vector<const Kernels*> findKernels() {
  std::vector<const Kernels*> found = {&kKernels_baseline};
#ifdef SPOOR_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2")) found.push_back(&kKernels_avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    found.push_back(&kKernels_avx512);
#endif
  return found;
}

}  // namespace

std::span<const Kernels* const> availableKernels() {
  static const std::vector<const Kernels*> found = findKernels();
  return found;
}

const Kernels& kernels() {
  static const Kernels& fastest = *availableKernels().back();
  return fastest;
}

}  // namespace spoor
