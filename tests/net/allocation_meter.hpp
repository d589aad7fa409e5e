#pragma once
#include <cstddef>

namespace peerd::net::testing_support {

// How often this thread has asked for memory since the program began: by operator new, which allocation_meter.cpp
// replaces. The sockets have no memory from anywhere else.
[[nodiscard]] std::size_t allocations();

}  // namespace peerd::net::testing_support
