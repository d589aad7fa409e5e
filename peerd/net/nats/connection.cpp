#include "peerd/net/nats/connection.hpp"

#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

namespace peerd::nats {
namespace {

// A server that does not answer for so long is passed by.
constexpr std::int64_t kConnect_ms = 2000;
// A server that says nothing for two of these is gone. Two peers that a leaf node joins notice a cut as late.
constexpr std::int64_t kPing_ms = 1000;
constexpr int kPingsOut = 2;
// Between two tries, when all servers have been tried. The jitter keeps peers apart that have lost one server.
constexpr std::int64_t kAgain_ms = 500, kJitter_ms = 500;
// A write that takes longer ends the connection; the worker waits for it.
constexpr std::int64_t kWrite_ms = 2000;
// So much may wait in the library for each subscription. The mailbox is what limits; this bounds the library's memory
// where its thread gets no processor.
constexpr int kPendingMessages = 8192, kPendingBytes = 8 << 20;

struct FreeOptions {
  void operator()(natsOptions* options) const { natsOptions_Destroy(options); }
};
using Options = std::unique_ptr<natsOptions, FreeOptions>;

// The library's callbacks are given this. The last one of a connection, or of a subscription, frees it.
struct ConnectionClosure {
  std::shared_ptr<ConnectionState> state;
};
struct SubscriptionClosure {
  std::shared_ptr<Mailbox> mailbox;
  RegionId region;
};

ConnectionState& state_of(void* closure) { return *static_cast<ConnectionClosure*>(closure)->state; }

std::string shown_url(natsConnection* connection) {
  std::array<char, 1024> url{};
  if (natsConnection_GetConnectedUrl(connection, url.data(), url.size()) != NATS_OK || url[0] == '\0') return "";
  const auto parsed = net::parse_server_url(url.data());
  return parsed ? parsed->shown() : std::string("a NATS server");
}

std::string last_error(natsConnection* connection) {
  const char* text = nullptr;
  const natsStatus status = natsConnection_GetLastError(connection, &text);
  if (text != nullptr && *text != '\0') return text;
  return status == NATS_OK ? "it has closed the connection" : natsStatus_GetText(status);
}

void on_disconnected(natsConnection* connection, void* closure) {
  state_of(closure).on_down("the NATS server is gone (" + last_error(connection) +
                            "): nothing is sent or heard until one answers");
}

void on_reconnected(natsConnection* connection, void* closure) {
  state_of(closure).on_up("goes on by NATS server " + shown_url(connection));
}

void on_closed(natsConnection* connection, void* closure) {
  const char* text = nullptr;
  const natsStatus why = natsConnection_GetLastError(connection, &text);
  state_of(closure).on_closed(why == NATS_OK || why == NATS_CONNECTION_CLOSED
                                  ? ""
                                  : "the NATS servers refuse this peer (" + last_error(connection) + ")");
  delete static_cast<ConnectionClosure*>(closure);
}

void on_error(natsConnection* connection, natsSubscription* /*subscription*/, natsStatus error, void* closure) {
  if (error == NATS_SLOW_CONSUMER) {
    return state_of(closure).warn("this computer is too slow for what comes by NATS: some of it is lost");
  }
  state_of(closure).warn("NATS server: " + last_error(connection));
}

void on_message(natsConnection* /*connection*/, natsSubscription* /*subscription*/, natsMsg* message, void* closure) {
  const auto& to = *static_cast<SubscriptionClosure*>(closure);
  to.mailbox->put(to.region, Message(message));
}

void on_no_more_messages(void* closure) { delete static_cast<SubscriptionClosure*>(closure); }

using Kind = net::NetError::Kind;

// The words of the library about the last failed call of this thread, without the place in its source: "(conn.c:733):
// ".
std::string reason() {
  natsStatus status = NATS_OK;
  const char* const last = nats_GetLastError(&status);
  std::string text = last == nullptr || *last == '\0' ? natsStatus_GetText(status) : last;
  if (const auto end = text.find("): "); text.starts_with('(') && end != std::string::npos) text.erase(0, end + 3);
  return text;
}

net::NetError error_of(Kind kind, const std::string& what) { return {kind, what + ": " + reason()}; }

// The files of the settings. An error names the key.
std::expected<void, net::NetError> load_files(natsOptions* options, const net::NatsSettings& settings) {
  const std::array<std::pair<const char*, const std::string*>, 4> files{{{"nats_credentials", &settings.credentials},
                                                                         {"nats_tls_ca", &settings.tls_ca},
                                                                         {"nats_tls_cert", &settings.tls_cert},
                                                                         {"nats_tls_key", &settings.tls_key}}};
  for (const auto& [key, file] : files) {
    if (file->empty() || access(file->c_str(), R_OK) == 0) continue;
    return std::unexpected(net::NetError{Kind::kBadSetting, fmt::format("transport.{}: can't read {}: {}", key, *file,
                                                                        std::generic_category().message(errno))});
  }
  const auto bad = [](const std::string& key, const std::string& file) {
    return std::unexpected(error_of(Kind::kBadSetting, "transport." + key + ": " + file));
  };
  if (!settings.credentials.empty() &&
      natsOptions_SetUserCredentialsFromFiles(options, settings.credentials.c_str(), nullptr) != NATS_OK) {
    return bad("nats_credentials", settings.credentials);
  }
  if (!settings.tls_ca.empty() && natsOptions_LoadCATrustedCertificates(options, settings.tls_ca.c_str()) != NATS_OK) {
    return bad("nats_tls_ca", settings.tls_ca);
  }
  if (!settings.tls_cert.empty() &&
      natsOptions_LoadCertificatesChain(options, settings.tls_cert.c_str(), settings.tls_key.c_str()) != NATS_OK) {
    return bad("nats_tls_cert", settings.tls_cert + " with " + settings.tls_key);
  }
  return {};
}

std::expected<Options, net::NetError> make_options(const NatsOptions& wanted, ConnectionClosure* closure) {
  natsOptions* made = nullptr;
  natsStatus s = natsOptions_Create(&made);
  Options options(made);
  std::vector<const char*> servers;
  bool tls = !wanted.settings.tls_ca.empty() || !wanted.settings.tls_cert.empty();
  for (const std::string& server : wanted.settings.servers) {
    servers.push_back(server.c_str());
    tls = tls || server.starts_with("tls://");
  }
  const auto set = [&s](natsStatus done) { s = s == NATS_OK ? done : s; };
  if (s == NATS_OK) {
    set(natsOptions_SetServers(made, servers.data(), static_cast<int>(servers.size())));
    set(natsOptions_SetName(made, wanted.name.c_str()));
    set(natsOptions_SetTimeout(made, kConnect_ms));
    set(natsOptions_SetPingInterval(made, kPing_ms));
    set(natsOptions_SetMaxPingsOut(made, kPingsOut));
    set(natsOptions_SetMaxReconnect(made, -1));
    set(natsOptions_SetReconnectWait(made, kAgain_ms));
    set(natsOptions_SetReconnectJitter(made, kJitter_ms, kJitter_ms));
    set(natsOptions_SetReconnectBufSize(made, 1));  // what can't leave now is not worth sending later
    set(natsOptions_SetWriteDeadline(made, kWrite_ms));
    set(natsOptions_SetNoEcho(made, true));
    set(natsOptions_SetSendAsap(made, true));
    set(natsOptions_UseGlobalMessageDelivery(made, true));  // one thread, not one for each region
    set(natsOptions_SetSecure(made, tls));
    set(natsOptions_SetDisconnectedCB(made, on_disconnected, closure));
    set(natsOptions_SetReconnectedCB(made, on_reconnected, closure));
    set(natsOptions_SetClosedCB(made, on_closed, closure));
    set(natsOptions_SetErrorHandler(made, on_error, closure));
  }
  if (s != NATS_OK) return std::unexpected(error_of(Kind::kOther, "NATS"));
  if (auto loaded = load_files(made, wanted.settings); !loaded) return std::unexpected(loaded.error());
  return options;
}

std::string servers_of(const NatsOptions& options) {
  std::string all;
  for (const std::string& server : options.settings.servers) {
    const auto url = net::parse_server_url(server);
    assert(url);
    all += (all.empty() ? "" : ", ") + url->shown();
  }
  return all;
}

Connection::Failure why_not_connected(natsStatus status, const NatsOptions& options) {
  const std::string servers = servers_of(options);
  switch (status) {
    case NATS_CONNECTION_AUTH_FAILED:
      return {true, error_of(Kind::kPermission, "the NATS server refuses this user (" + servers +
                                                    "; transport.nats_credentials, or the user in transport.nats)")};
    case NATS_SSL_ERROR:
    case NATS_SECURE_CONNECTION_WANTED:
    case NATS_SECURE_CONNECTION_REQUIRED:
      return {true, error_of(Kind::kOther, "no TLS with the NATS server (" + servers + "; transport.nats_tls_ca)")};
    case NATS_NO_SERVER_SUPPORT:
      return {true, error_of(Kind::kOther, "the NATS server is too old (" + servers + ")")};
    case NATS_NO_SERVER:
    case NATS_TIMEOUT:
    case NATS_IO_ERROR:
    case NATS_STALE_CONNECTION:
    case NATS_CONNECTION_DISCONNECTED:
      return {false, error_of(Kind::kOther, "no NATS server answers at " + servers)};
    case NATS_CONNECTION_CLOSED:
    case NATS_PROTOCOL_ERROR:  // so a server with TLS ends the connection of who shows no certificate
      return {false, error_of(Kind::kOther, "the NATS server ends the connection (" + servers +
                                                "; it may want transport.nats_tls_cert)")};
    default:
      return {true, error_of(Kind::kOther, "no connection to the NATS server (" + servers + ")")};
  }
}

std::expected<void, net::NetError> check_payload(natsConnection* connection) {
  const std::int64_t most = natsConnection_GetMaxPayload(connection);
  if (most >= static_cast<std::int64_t>(net::kMaxDatagramBytes)) return {};
  return std::unexpected(net::NetError{
      Kind::kLimit,
      fmt::format("the NATS server {} takes messages of {} bytes at most: set its max_payload to {} at least",
                  shown_url(connection), most, net::kMaxDatagramBytes)});
}

}  // namespace

Connection::Connection(const NatsOptions& options, std::shared_ptr<Mailbox> mailbox)
    : subjects_(options.settings.subject, options.world, options.session), mailbox_(std::move(mailbox)) {}

std::expected<std::unique_ptr<Connection>, Connection::Failure> Connection::open(
    const NatsOptions& options, std::shared_ptr<Mailbox> mailbox, std::shared_ptr<ConnectionState> state) {
  assert(!options.settings.servers.empty());
  state->begin();
  auto closure = std::make_unique<ConnectionClosure>(state);
  const auto made = make_options(options, closure.get());
  if (!made) return std::unexpected(Failure{true, made.error()});
  std::unique_ptr<Connection> connection(new Connection(options, std::move(mailbox)));
  natsConnection* connected = nullptr;
  const natsStatus status = natsConnection_Connect(&connected, made->get());
  // No callback is called of a connection that was never made.
  if (status != NATS_OK) return std::unexpected(why_not_connected(status, options));
  connection->connection_.reset(connected);
  (void)closure.release();  // on_closed() frees it, and may have done so
  if (auto enough = check_payload(connected); !enough) return std::unexpected(Failure{true, enough.error()});
  state->on_up("goes on by NATS server " + shown_url(connected));
  return connection;
}

// The subscriptions go first; what still comes goes to the mailbox, which lives as long as a closure has it.
Connection::~Connection() {
  subscriptions_.clear();
  connection_.reset();
}

natsStatus Connection::subscribe(RegionId region) {
  if (subscriptions_.contains(region)) return NATS_OK;
  auto closure = std::make_unique<SubscriptionClosure>(mailbox_, region);
  natsSubscription* made = nullptr;
  natsStatus s =
      natsConnection_Subscribe(&made, connection_.get(), subjects_.of(region).c_str(), on_message, closure.get());
  if (s != NATS_OK) return s;
  Subscription subscription(made);
  s = natsSubscription_SetPendingLimits(made, kPendingMessages, kPendingBytes);
  // Nobody would free the closure where the connection is closed by now, and it stays.
  SubscriptionClosure* const kept = closure.release();
  if (s == NATS_OK) s = natsSubscription_SetOnCompleteCB(made, on_no_more_messages, kept);
  if (s == NATS_OK) subscriptions_.emplace(region, std::move(subscription));
  return s;
}

natsStatus Connection::unsubscribe(RegionId region) {
  const auto subscription = subscriptions_.find(region);
  if (subscription == subscriptions_.end()) return NATS_OK;
  std::int64_t thrown_away = 0;
  if (natsSubscription_GetDropped(subscription->second.get(), &thrown_away) == NATS_OK) {
    thrown_away_ += static_cast<std::uint64_t>(thrown_away);
  }
  const natsStatus s = natsSubscription_Unsubscribe(subscription->second.get());
  subscriptions_.erase(subscription);
  return s;
}

natsStatus Connection::publish(RegionId region, std::span<const std::byte> datagram) {
  return natsConnection_Publish(connection_.get(), subjects_.of(region).c_str(), datagram.data(),
                                static_cast<int>(datagram.size()));
}

std::uint64_t Connection::thrown_away() {
  std::uint64_t all = thrown_away_;
  for (const auto& [region, subscription] : subscriptions_) {
    std::int64_t of_one = 0;
    if (natsSubscription_GetDropped(subscription.get(), &of_one) == NATS_OK) all += static_cast<std::uint64_t>(of_one);
  }
  return all;
}

std::string Connection::server() const { return shown_url(connection_.get()); }

}  // namespace peerd::nats
