#pragma once

// Programs that link allocation_counter.cpp count what operator new gives out; sanitizers bring their own, and there
// PEERD_COUNTS_ALLOCATIONS is 0.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PEERD_COUNTS_ALLOCATIONS 0
#else
#define PEERD_COUNTS_ALLOCATIONS 1
#endif

namespace peerd {

// The number of this thread's allocations since it began.
[[nodiscard]] long allocations();

}  // namespace peerd
