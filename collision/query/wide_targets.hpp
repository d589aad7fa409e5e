#pragma once
// Before <hwy/foreach_target.h>: Highway 1.0 doesn't make this set by itself, and stops where it is what the compiler
// may use anyway.
#if defined(__AVX512VNNI__) && !defined(HWY_WANT_AVX3_DL)
#define HWY_WANT_AVX3_DL
#endif
