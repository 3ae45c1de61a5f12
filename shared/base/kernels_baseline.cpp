#define SPOOR_KERNELS_NAME baseline
#include "shared/base/kernels.inl"
