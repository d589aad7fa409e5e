#include "peerd/view/gateway/access.hpp"

#include <algorithm>
#include <array>
#include <random>

#include <boost/asio/ip/address.hpp>

namespace peerd::gateway {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr std::uint16_t kHttpPort = 80;  // which "Host" leaves out

bool same_letters(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

}  // namespace

std::string make_token() {
  std::random_device random;  // getrandom(2), or the processor's own source
  std::string token;
  for (int digits = 0; digits < 22; ++digits) token += kDigits[random() % kDigits.size()];  // 132 bits
  return token;
}

bool is_token(std::string_view given, std::string_view token) {
  if (given.size() != token.size() || token.empty()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < token.size(); ++i) {
    different |= static_cast<unsigned>(static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(token[i]));
  }
  return different == 0;
}

std::string_view bearer_token(std::string_view authorization) {
  constexpr std::string_view kScheme = "Bearer ";
  if (!same_letters(authorization.substr(0, kScheme.size()), kScheme)) return {};
  return authorization.substr(kScheme.size());
}

bool is_own_host(std::string_view host, std::uint16_t port) {
  const auto colon = host.rfind(':');
  const bool has_port = colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos;
  std::string name(has_port ? host.substr(0, colon) : host);
  const std::string_view written = has_port ? host.substr(colon + 1) : std::string_view();
  if (has_port ? written != std::to_string(port) : port != kHttpPort) return false;
  if (same_letters(name, "localhost")) return true;
  const bool is_v6 = name.starts_with('[') && name.ends_with(']') && name.size() > 2;
  if (is_v6) name = name.substr(1, name.size() - 2);
  boost::system::error_code failed;
  const auto address = boost::asio::ip::make_address(name, failed);
  return !failed && address.is_v6() == is_v6;
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && same_letters(origin.substr(kScheme.size()), host);
}

bool is_origin(std::string_view text) {
  const std::string_view scheme = text.starts_with("https://") ? "https://" : "http://";
  if (!text.starts_with(scheme) || text.size() == scheme.size()) return false;
  const auto in_host = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view(".-_:[]").find(c) != std::string_view::npos;
  };
  return std::ranges::all_of(text.substr(scheme.size()), in_host);
}

}  // namespace peerd::gateway
