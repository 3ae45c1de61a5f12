#define SPOOR_KERNELS_NAME avx512
#include "shared/base/kernels.inl"
