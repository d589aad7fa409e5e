#include "peerd/running/session_seal.hpp"

#include <memory>
#include <utility>

#include "peerd/input/user_folder.hpp"
#include "peerd/seal/key_file.hpp"
#include "peerd/seal/sealed_transport.hpp"
#include "replication/wire/envelope.hpp"

namespace peerd {
namespace {

// Dead reckoning is too frequent to be signed, and is checked afterwards.
std::optional<seal::Contents> contents_of(std::span<const std::byte> datagram) {
  const auto envelope = replication::envelope_of(datagram);
  if (!envelope) return std::nullopt;
  return seal::Contents{envelope->sender, !envelope->has_only_updates};
}

}  // namespace

Result<seal::Identity> peer_identity(const config::TransportSettings& settings) {
  const auto file = seal::chosen_identity_file(settings.identity_file);
  if (!file) return std::unexpected(file.error());
  return settings.identity_file.empty() ? seal::read_or_make_identity(*file) : seal::read_identity(*file);
}

Result<std::optional<seal::SymmetricKey>> session_key(const config::TransportSettings& settings,
                                                      const std::string& world, const SayLine& say) {
  if (!settings.sealed) {
    say({LogLevel::kWarning, "open: whoever is on this network can listen, and speak as any peer"});
    return std::nullopt;
  }
  const auto file = seal::chosen_key_file(settings.key_file, world);
  if (!file) return std::unexpected(file.error());
  auto key = settings.key_file.empty() ? seal::read_or_make_key(*file) : seal::read_key(*file);
  if (!key) return std::unexpected(key.error());
  say({LogLevel::kInfo, "sealed by the key " + file->string()});
  return *std::move(key);
}

void seal_transport(boost::asio::io_context& io, const net::HostClock& clock, const seal::SymmetricKey& key,
                    PeerId self, const seal::Identity& identity, net::OpenedTransport& reached, const SayLine& say) {
  reached.transport = std::make_unique<seal::SealedTransport>(
      io, clock, std::move(reached.transport), seal::Sealer(key, {.peer = self, .identity = identity}), contents_of,
      [say](const std::string& line) { say({LogLevel::kWarning, line}); });
}

}  // namespace peerd
