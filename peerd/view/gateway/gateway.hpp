#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "peerd/input/input_error.hpp"
#include "peerd/peer/control/event_sink.hpp"
#include "peerd/peer/node/log_line.hpp"
#include "peerd/view/gateway/gateway_counters.hpp"
#include "peerd/view/gateway/gateway_source.hpp"
#include "peerd/view/gateway/viewer_assets.hpp"

namespace peerd::gateway {

// Shows a peer by HTTP and WebSocket (docs/reference/gateway.md), in the one thread of the peer's io_context. It never
// waits for a client.
class Gateway : public control::EventSink {
 public:
  struct Options {
    boost::asio::ip::tcp::endpoint at;  // port 0: the system chooses one
    ViewerAssets assets{};
    std::string token;
    std::vector<std::string> origins{};  // whose pages may ask, too
    std::function<void(const LogLine&)> log;
  };

  // The source outlives the gateway. The error says why it cannot listen.
  [[nodiscard]] static Result<std::unique_ptr<Gateway>> open(boost::asio::io_context& io, GatewaySource& source,
                                                             Options options);
  ~Gateway() override;

  [[nodiscard]] boost::asio::ip::tcp::endpoint endpoint() const;
  // The address at which a browser finds it, with the token.
  [[nodiscard]] std::string url() const;

  [[nodiscard]] control::EventKinds wanted() const override;
  void publish(control::EventKind kind, const std::string& line) override;

  [[nodiscard]] const GatewayCounters& counters() const;
  [[nodiscard]] std::size_t connections() const;

 private:
  class Impl;
  explicit Gateway(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace peerd::gateway
