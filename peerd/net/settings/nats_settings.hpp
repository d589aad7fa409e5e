#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

namespace peerd::net {

// The keys of the table [transport] that begin with `nats`: datagrams go through NATS servers in place of multicast.
struct NatsSettings {
  std::vector<std::string> servers;  // URLs, which parse_server_url() takes; empty: without NATS
  std::string subject = "peerd";     // what all subjects begin with
  std::string credentials;           // a .creds file (a user's JWT and its NKey); empty: none
  std::string tls_ca;                // certificates of authorities; empty: the system's
  std::string tls_cert, tls_key;     // of this peer, for servers that verify it; both or neither
};

// The address of a NATS server: "nats://[USER[:PASSWORD]@]HOST[:PORT]", or "tls://..", which requires TLS. An IPv6
// address stands in brackets. The port is 4222 where none is given.
struct ServerUrl {
  std::string user_info;  // "USER:PASSWORD", "USER", a token, or empty; secret
  std::string host;
  std::uint16_t port = 4222;
  bool tls = false;

  // For people, logs and joining peers: without the user and the password.
  [[nodiscard]] std::string shown() const;
};

// The error says what is wrong with the text, and does not repeat it: it may hold a password.
[[nodiscard]] std::expected<ServerUrl, std::string> parse_server_url(std::string_view text);

// Whether the text is one or more tokens of letters, digits, '-' and '_', with dots between them.
[[nodiscard]] bool is_subject(std::string_view text);

}  // namespace peerd::net
