#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace peerd::gateway {

// These rules say who may ask, and who may change something.

// 128 random bits of the operating system, in base64url.
[[nodiscard]] std::string make_token();
// Compares in a time that depends on the lengths alone.
[[nodiscard]] bool is_token(std::string_view given, std::string_view token);
// The token of "Authorization: Bearer TOKEN"; empty where there is none.
[[nodiscard]] std::string_view bearer_token(std::string_view authorization);

// Whether "Host" names this server: an address or "localhost", with its port. A name of DNS could be anybody's, who
// lets it point to this computer (DNS rebinding).
[[nodiscard]] bool is_own_host(std::string_view host, std::uint16_t port);
// Whether a page of the server that "Host" names asks.
[[nodiscard]] bool is_own_origin(std::string_view origin, std::string_view host);
// Whether a browser could send that as "Origin": a scheme, a host and, unless it is the scheme's own, a port. "null",
// which pages of files and sandboxes send, names nobody.
[[nodiscard]] bool is_origin(std::string_view text);

}  // namespace peerd::gateway
