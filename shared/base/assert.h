#pragma once

#include <cstdio>
#include <cstdlib>

/// Checks what the caller must guarantee. On in every build unless SPOOR_NO_ASSERT is defined.
#ifdef SPOOR_NO_ASSERT
#define SPOOR_ASSERT(condition) ((void)0)
#else
#define SPOOR_ASSERT(condition) \
  ((condition)                  \
       ? (void)0                \
       : (std::fprintf(stderr, "%s:%d: assertion failed: %s\n", __FILE__, __LINE__, #condition), std::abort()))
#endif
