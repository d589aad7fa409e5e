#pragma once
#include <cstddef>

namespace peerd::net::testing_support {

// The number of calls of operator new, which allocation_meter.cpp replaces, by this thread since the program began. The
// sockets have no other source of memory.
[[nodiscard]] std::size_t allocations();

}  // namespace peerd::net::testing_support
