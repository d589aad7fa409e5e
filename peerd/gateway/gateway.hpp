#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "peerd/control/event_sink.hpp"
#include "peerd/gateway/gateway_counters.hpp"
#include "peerd/gateway/gateway_source.hpp"
#include "peerd/gateway/viewer_assets.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/node/log_line.hpp"

namespace peerd::gateway {

// Shows a peer by HTTP and WebSocket (docs/reference/gateway.md), in the one thread of the peer's io_context. It never
// waits for a client.
class Gateway : public api::EventSink {
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

  [[nodiscard]] api::EventKinds wanted() const override;
  void publish(api::EventKind kind, const std::string& line) override;

  [[nodiscard]] const GatewayCounters& counters() const;
  [[nodiscard]] std::size_t connections() const;

 private:
  class Impl;
  explicit Gateway(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace peerd::gateway
