#include "peerd/net/settings/nats_settings.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>

namespace peerd::net {
namespace {

bool belongs_to_token(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

}  // namespace

std::string ServerUrl::shown() const {
  const bool is_v6 = host.find(':') != std::string::npos;
  return fmt::format("{}://{}{}{}:{}", tls ? "tls" : "nats", is_v6 ? "[" : "", host, is_v6 ? "]" : "", port);
}

std::expected<ServerUrl, std::string> parse_server_url(std::string_view text) {
  ServerUrl url;
  url.tls = text.starts_with("tls://");
  if (!url.tls && !text.starts_with("nats://")) return std::unexpected("it has to begin with nats:// or tls://");
  text.remove_prefix(text.find("//") + 2);
  if (const auto at = text.rfind('@'); at != std::string_view::npos) {
    url.user_info = text.substr(0, at);
    text.remove_prefix(at + 1);
  }
  const bool in_brackets = text.starts_with('[');
  const auto end = in_brackets ? text.find(']') : text.find(':');
  if (in_brackets && end == std::string_view::npos) return std::unexpected("a bracket is not closed");
  url.host = text.substr(in_brackets ? 1 : 0, in_brackets ? end - 1 : end);
  if (url.host.empty() || url.host.find_first_of(" \t\r\n/,?#[]") != std::string::npos) {
    return std::unexpected("it names no host");
  }
  text.remove_prefix(in_brackets ? end + 1 : std::min(end, text.size()));
  if (text.empty()) return url;
  const char* const last = text.data() + text.size();
  const auto read = std::from_chars(text.data() + 1, last, url.port);
  if (text.front() != ':' || read.ec != std::errc{} || read.ptr != last || url.port == 0) {
    return std::unexpected("its port is no number from 1 to 65535");
  }
  return url;
}

bool is_subject(std::string_view text) {
  return !text.empty() && text.front() != '.' && text.back() != '.' && text.find("..") == std::string_view::npos &&
         std::ranges::all_of(text, [](char c) { return c == '.' || belongs_to_token(c); });
}

}  // namespace peerd::net
