#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/net/keys/identity.hpp"
#include "peerd/net/keys/roster.hpp"
#include "peerd/net/keys/session_key.hpp"
#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/seal/operation_signer.hpp"
#include "peerd/net/seal/sealed_greetings.hpp"
#include "peerd/net/seal/sealed_transport.hpp"
#include "peerd/net/transport/open_transport.hpp"
#include "peerd/peer/config/peer_settings.hpp"
#include "peerd/peer/node/describe.hpp"

namespace peerd {

using SayLine = std::function<void(const LogLine&)>;

// Reads who this peer's user is: the settings' file, else the user's own, which is made where there is none. Where that
// can't be made, the identity is one of this start alone, and somebody is told.
[[nodiscard]] Result<keys::Identity> peer_identity(const net::TransportSettings& settings, const SayLine& say);

// What the seal needs to know of a peer's datagram; none: peers send no such thing.
[[nodiscard]] std::optional<seal::Contents> contents_of(std::span<const std::byte> datagram);

// The error of who has a roster that does not name them.
[[nodiscard]] InputError not_a_member(const std::filesystem::path& roster, const keys::Identity& identity);

// A SessionSeal is what a running peer's session is sealed by: nothing, a key, or the keys that a roster has, which may
// change while it runs.
class SessionSeal {
 public:
  // Chooses by the settings and by what this user has of the world. `given`: a key that has been found already. Errors:
  // the identity is no member's; files that are damaged or can't be read.
  [[nodiscard]] static Result<std::unique_ptr<SessionSeal>> choose(const net::TransportSettings& settings,
                                                                   const std::string& world,
                                                                   const keys::Identity& identity,
                                                                   const std::optional<keys::SessionKey>& given);
  // The words for what it is sealed by: "the key FILE"; empty: it is open.
  [[nodiscard]] const std::string& by() const { return by_; }
  [[nodiscard]] LogLine line() const;  // for the log
  // The peers that are heard and hear nothing of this one, as far as the seal knows (Sealer::deaf_peers).
  [[nodiscard]] std::vector<PeerId> deaf_peers() const {
    return transport_ == nullptr ? std::vector<PeerId>{} : transport_->deaf_peers();
  }
  // The session's key at present; none: it is open.
  [[nodiscard]] const std::optional<keys::SymmetricKey>& key() const { return rosters_ ? rosters_->key() : key_; }
  // An observer owns nothing.
  [[nodiscard]] Result<void> check_owner(bool owns_something) const;
  // Whether operations by that key count.
  [[nodiscard]] bool may_write(const keys::PublicKey& key) const {
    return !rosters_ || rosters_->current().may_write(key);
  }
  // Who a user is, and what it may do to locks: administrators lock, or where there is no roster everybody.
  [[nodiscard]] replication::Writer writer(const keys::PublicKey& key) const {
    return rosters_ ? seal::writer_by(rosters_->current(), key) : seal::writer_without_roster(key);
  }

  // The text of the roster by which the session is sealed; empty: by none.
  [[nodiscard]] std::string roster() const { return rosters_ ? rosters_->current().text() : std::string(); }
  // Called with the text of each roster that is followed from now on: members may do more than they might.
  void on_roster(std::function<void(const std::string&)> followed) { followed_ = std::move(followed); }

  // The seal of the greetings of unicast, in this epoch and the next ones; null: they are open.
  [[nodiscard]] std::shared_ptr<net::GreetingSeal> greetings(const SayLine& say);
  // The transport seals all that it carries from then on. Rosters that come, over the network or into the file, are
  // followed. This and all else that is given outlive it.
  void seal(boost::asio::io_context& io, const net::HostClock& clock, PeerId self, net::OpenedTransport& reached,
            const SayLine& say);

 private:
  explicit SessionSeal(const keys::Identity& identity) : identity_(identity) {}
  void adopt(const keys::Roster& roster, const SayLine& say);
  void watch_file(const SayLine& say);

  keys::Identity identity_;
  std::filesystem::path file_;  // of the roster
  std::string by_;
  std::optional<keys::SymmetricKey> key_;        // of a session without a roster
  std::optional<seal::RosterExchange> rosters_;  // of one with it
  std::shared_ptr<seal::SealedGreetings> greetings_;
  seal::SealedTransport* transport_ = nullptr;
  std::function<void(const std::string&)> followed_;
  std::optional<boost::asio::steady_timer> timer_;
  std::filesystem::file_time_type seen_{};
};

}  // namespace peerd
