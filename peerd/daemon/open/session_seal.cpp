#include "peerd/daemon/open/session_seal.hpp"

#include <cassert>
#include <system_error>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/daemon/open/roster_file.hpp"
#include "peerd/net/keys/key_file.hpp"
#include "replication/wire/envelope.hpp"

namespace peerd {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::seconds kFileChecked{1};

}  // namespace

// Dead reckoning is too frequent to be signed, and is checked afterwards.
std::optional<seal::Contents> contents_of(std::span<const std::byte> datagram) {
  const auto envelope = replication::envelope_of(datagram);
  if (!envelope) return std::nullopt;
  return seal::Contents{envelope->sender, !envelope->has_only_updates, envelope->changes_world};
}

Result<keys::Identity> peer_identity(const net::TransportSettings& settings, const SayLine& say) {
  const auto file = keys::chosen_identity_file(settings.identity_file);
  if (!settings.identity_file.empty()) return keys::read_identity(*file);
  auto own = file ? keys::read_or_make_identity(*file) : Result<keys::Identity>(std::unexpected(file.error()));
  std::error_code failed;
  if (own || (file && std::filesystem::exists(*file, failed))) return own;
  say({LogLevel::kWarning, "has an identity of this start alone, by which nobody knows it again: " + own.error().text});
  return keys::Identity::random();
}

InputError not_a_member(const std::filesystem::path& roster, const keys::Identity& identity) {
  return {fmt::format("error: by the roster {} this user is no member: an administrator adds {}", roster.string(),
                      identity.public_key().text()),
          2};
}

Result<std::unique_ptr<SessionSeal>> SessionSeal::choose(const net::TransportSettings& settings,
                                                         const std::string& world, const keys::Identity& identity,
                                                         const std::optional<keys::SessionKey>& given) {
  std::unique_ptr<SessionSeal> chosen(new SessionSeal(identity));
  if (!settings.sealed) return chosen;
  const auto roster_file = chosen_roster_file(settings.roster_file, world);
  const keys::KeyChoice said{settings.key_file, settings.password_file};
  if (roster_file && said.key_file.empty() && said.password_file.empty()) {
    auto roster = read_roster(*roster_file);
    if (!roster) return std::unexpected(roster.error());
    if (*roster) {
      chosen->file_ = *roster_file;
      chosen->rosters_.emplace(**roster, read_earlier_rosters(*roster_file), identity);
      chosen->by_ = "the roster " + roster_file->string();
      if (chosen->key()) return chosen;
      return std::unexpected(not_a_member(*roster_file, identity));
    }
    if (!settings.roster_file.empty()) {
      return std::unexpected(InputError{"error: there is no roster " + settings.roster_file, kWrongUse});
    }
  }
  auto key = given ? Result<keys::SessionKey>(*given) : keys::session_key(said, world, keys::IfMissing::kMake);
  if (!key) return std::unexpected(key.error());
  chosen->by_ = key->by;
  chosen->key_ = key->key;
  return chosen;
}

Result<void> SessionSeal::check_owner(bool owns_something) const {
  if (!owns_something || may_write(identity_.public_key())) return {};
  return std::unexpected(
      InputError{"error: this peer is an observer, by the world's roster, and can own nothing", kWrongUse});
}

LogLine SessionSeal::line() const {
  if (!key()) return {LogLevel::kWarning, "open: whoever is on this network can listen, and speak as any peer"};
  if (!rosters_) return {LogLevel::kInfo, "sealed by " + by_};
  const keys::Roster& roster = rosters_->current();
  const keys::Member* const self = roster.find(identity_.public_key());
  return {LogLevel::kInfo, fmt::format("sealed by {}, epoch {}; this is {}, {}", by_, roster.epoch(), self->name,
                                       keys::name_of(self->role))};
}

std::shared_ptr<net::GreetingSeal> SessionSeal::greetings(const SayLine& say) {
  if (!key()) return nullptr;
  greetings_ =
      std::make_shared<seal::SealedGreetings>(seal::SealedGreetings::key_of(*key()), [say](const std::string& line) {
        say({LogLevel::kWarning, line});
      });
  return greetings_;
}

void SessionSeal::seal(asio::io_context& io, const net::HostClock& clock, PeerId self, net::OpenedTransport& reached,
                       const SayLine& say) {
  if (!key()) return;
  const auto warn = [say](const std::string& line) { say({LogLevel::kWarning, line}); };
  seal::Sealer::Self as{.peer = self, .identity = identity_};
  if (!rosters_) {
    auto transport = std::make_unique<seal::SealedTransport>(io, clock, std::move(reached.transport), *key_,
                                                             std::move(as), contents_of, warn);
    transport_ = transport.get();
    reached.transport = std::move(transport);
    return;
  }
  const auto on_roster = [this, say](const keys::Roster& roster) {
    if (const auto saved = save_roster(file_, roster); !saved) say({LogLevel::kWarning, saved.error().text});
    adopt(roster, say);
  };
  auto transport = std::make_unique<seal::SealedTransport>(io, clock, std::move(reached.transport), *rosters_,
                                                           on_roster, std::move(as), contents_of, warn);
  transport_ = transport.get();
  reached.transport = std::move(transport);
  timer_.emplace(io);
  watch_file(say);
}

void SessionSeal::adopt(const keys::Roster& roster, const SayLine& say) {
  assert(transport_ != nullptr);
  if (!rosters_->current().is_followed_by(roster)) return;
  if (!rosters_->adopt(roster)) {
    return say(
        {LogLevel::kWarning, "this peer is no member of \"" + roster.world() + "\" any more: it goes on by itself"});
  }
  transport_->follow_roster();
  if (followed_) followed_(roster.text());
  if (greetings_) greetings_->rekey(seal::SealedGreetings::key_of(*key()));
  say(line());
}

// An administrator's command writes the file; its peers tell the others.
void SessionSeal::watch_file(const SayLine& say) {
  std::error_code failed;
  const auto changed = std::filesystem::last_write_time(file_, failed);
  if (!failed && changed != std::exchange(seen_, changed)) {
    const auto roster = read_roster(file_);
    if (!roster) {
      say({LogLevel::kWarning, roster.error().text});
    } else if (*roster) {
      adopt(**roster, say);
    }
  }
  timer_->expires_after(kFileChecked);
  timer_->async_wait([this, say](const boost::system::error_code& cancelled) {
    if (!cancelled) watch_file(say);
  });
}

}  // namespace peerd
