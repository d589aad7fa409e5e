#pragma once
#include <boost/asio/io_context.hpp>
#include <functional>
#include <optional>
#include <string>

#include "core/ids.hpp"
#include "peerd/config/peer_settings.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/node/describe.hpp"
#include "peerd/os/host_clock.hpp"
#include "peerd/seal/identity.hpp"
#include "peerd/seal/symmetric_key.hpp"
#include "peerd/transport/open_transport.hpp"

namespace peerd {

using SayLine = std::function<void(const LogLine&)>;

// Who this peer's user is: by the settings' file, else the user's own, which is made where there is none.
[[nodiscard]] Result<seal::Identity> peer_identity(const config::TransportSettings& settings);

// The key of the session, unless the settings say that it is open. The line says which it is.
[[nodiscard]] Result<std::optional<seal::SymmetricKey>> session_key(const config::TransportSettings& settings,
                                                                    const std::string& world, const SayLine& say);

// What the transport carries is sealed from then on. All but the transport outlive it.
void seal_transport(boost::asio::io_context& io, const net::HostClock& clock, const seal::SymmetricKey& key,
                    PeerId self, const seal::Identity& identity, net::OpenedTransport& reached, const SayLine& say);

}  // namespace peerd
