#include "peerd/view/gateway/listen_address.hpp"

#include <cstdint>
#include <limits>

#include "peerd/input/number.hpp"

namespace peerd::gateway {

Result<boost::asio::ip::tcp::endpoint> listen_address(std::string_view text, bool beyond_loopback) {
  const auto wrong = [&](const std::string& why) {
    return std::unexpected(InputError{"error: the viewer can't be served at \"" + std::string(text) + "\": " + why});
  };
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos) return wrong("it has to be ADDRESS:PORT, such as 127.0.0.1:0");
  std::string address(text.substr(0, colon));
  const bool is_v6 = address.starts_with('[') && address.ends_with(']');
  if (is_v6) address = address.substr(1, address.size() - 2);
  boost::system::error_code failed;
  const auto at = boost::asio::ip::make_address(address, failed);
  if (failed || at.is_v6() != is_v6) return wrong("it has to be ADDRESS:PORT, such as 127.0.0.1:0 or [::1]:0");
  const auto port = parse_whole_number(text.substr(colon + 1), 0, std::numeric_limits<std::uint16_t>::max());
  if (!port) return wrong("the port " + port.error());
  if (!at.is_loopback() && !beyond_loopback) {
    return wrong(
        "other computers could reach it, and nothing is encrypted; use a tunnel of ssh, or set "
        "gateway.beyond_loopback = true");
  }
  return boost::asio::ip::tcp::endpoint(at, static_cast<std::uint16_t>(*port));
}

}  // namespace peerd::gateway
