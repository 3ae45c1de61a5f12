#define SPOOR_KERNELS_NAME avx2
#include "shared/base/kernels.inl"
