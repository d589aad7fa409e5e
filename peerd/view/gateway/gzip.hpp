#pragma once
#include <string>
#include <string_view>

namespace peerd::gateway {

// Unpacks a file of the viewer, which the build has packed by gzip (RFC 1952).
[[nodiscard]] std::string gunzip(std::string_view packed);

}  // namespace peerd::gateway
