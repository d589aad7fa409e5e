#include "peerd/peer/record/setup.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/net/keys/base64.hpp"
#include "peerd/net/keys/little_endian.hpp"
#include "replication/edits/log/log_signer.hpp"

namespace peerd::record {
namespace {

constexpr int kFormat = 1;
constexpr std::array<std::string_view, 3> kDatagramWords{"open", "opened", "sealed"};  // by Setup::Datagrams

}  // namespace

Setup make_setup(const config::Scenario& scenario, const config::RunSettings& run, const config::PeerSettings& peer,
                 const std::filesystem::path& file, const SharedWorld& shared, const PeerNode::Options& options,
                 net::GroupPlan groups) {
  return {.peer = peer.name,
          .configuration = run.toml,
          .file = std::filesystem::absolute(file.empty() ? "peerd" : file),
          .world = std::filesystem::absolute(scenario.world),
          .world_hash = shared.world.hash,
          .reading = scenario.reading,
          .options = options,
          .groups = std::move(groups),
          .author_key = options.signer == nullptr ? std::vector<std::byte>() : options.signer->own_key()};
}

std::string to_text(const Setup& s) {
  nlohmann::ordered_json wait_for = nlohmann::ordered_json::array();
  for (const AwaitedPeer& peer : s.options.wait_for) wait_for.push_back(peer.id.value);
  const net::GroupPlan& g = s.groups;
  const nlohmann::ordered_json groups{
      {"base", g.base.to_string()}, {"port", g.port}, {"pool", g.pool}, {"offset", g.offset}};
  nlohmann::ordered_json json{{"format", kFormat},
                              {"peer", s.peer},
                              {"boot", s.options.incarnation},
                              {"wait_for", wait_for},
                              {"late", s.options.late},
                              {"watches", s.options.watches},
                              {"start_lead_ns", s.options.start_lead.count()},
                              {"clock_offset_ns", s.options.clock_offset.count()},
                              {"keep_log", s.options.keep_log},
                              {"sample_hz", s.options.sample_hz},
                              {"groups", groups},
                              {"datagrams", kDatagramWords.at(static_cast<std::size_t>(s.datagrams))},
                              {"world", s.world.string()},
                              {"world_hash", s.world_hash},
                              {"inlines_when_needed", s.reading.inlines_when_needed},
                              {"expansion", s.reading.expansion},
                              {"lenient", s.reading.lenient},
                              {"collide", s.reading.collide},
                              {"unit", s.reading.unit},
                              {"up", s.reading.up},
                              {"world_name", s.reading.name},
                              {"file", s.file.string()},
                              {"configuration", s.configuration}};
  if (s.options.line != 0) json["line"] = s.options.line;
  if (s.options.joins) json["joins"] = true;
  if (s.options.author) json["author"] = s.options.author->value;
  if (!s.author_key.empty())
    json["author_key"] = keys::base64_of(keys::as_octets(std::span<const std::byte>(s.author_key)));
  if (!s.roster.empty()) json["roster"] = s.roster;
  // Paths may not be UTF-8. A path with a replaced character will be reported as missing.
  return json_line(json);
}

std::expected<Setup, std::string> setup_from(std::string_view text) {
  Setup s;
  try {
    const auto json = parse_json(text);
    if (const int format = json.at("format").get<int>(); format != kFormat) {
      return std::unexpected("what is recorded is of format " + std::to_string(format) + ", and this program reads " +
                             std::to_string(kFormat));
    }
    s.peer = json.at("peer").get<std::string>();
    s.options.incarnation = json.at("boot").get<std::uint64_t>();
    for (const auto& peer : json.at("wait_for")) s.options.wait_for.push_back({PeerId{peer.get<std::uint32_t>()}, ""});
    s.options.late = json.value("late", false);  // older captures have none
    s.options.watches = json.value("watches", false);
    s.options.start_lead = Duration{json.at("start_lead_ns").get<std::int64_t>()};
    s.options.clock_offset = Duration{json.at("clock_offset_ns").get<std::int64_t>()};
    s.options.line = json.value("line", std::uint64_t{0});  // older captures have none
    s.options.joins = json.value("joins", false);
    s.options.keep_log = json.at("keep_log").get<bool>();
    s.options.sample_hz = json.at("sample_hz").get<std::uint32_t>();
    const auto& groups = json.at("groups");
    auto plan = net::parse_group_plan(groups.at("base").get<std::string>(), groups.at("port").get<std::uint16_t>(),
                                      groups.at("pool").get<std::uint32_t>());
    if (!plan) return std::unexpected(plan.error().sentence);
    s.groups = *plan;
    s.groups.offset = groups.value("offset", 0U);  // format 1 without "offset" means 0
    const auto word =
        std::ranges::find(kDatagramWords, json.value("datagrams", std::string("open")));  // older captures have none
    if (word == kDatagramWords.end())
      return std::unexpected("it says of its datagrams what this program does not know");
    s.datagrams = static_cast<Setup::Datagrams>(word - kDatagramWords.begin());
    if (json.contains("author")) {
      s.options.author = replication::AuthorId{json.at("author").get<std::uint32_t>()};
      if (*s.options.author == replication::kNoAuthor || s.options.author->value > replication::kAuthorMax) {
        return std::unexpected("it has no such author");
      }
    }
    const auto key = json.value("author_key", "");
    s.author_key.resize(key.size());
    const auto key_bytes = keys::read_base64(key, keys::as_octets(std::span<std::byte>(s.author_key)));
    if (!key_bytes) return std::unexpected("its author's key is damaged");
    s.author_key.resize(*key_bytes);
    s.roster = json.value("roster", "");
    s.world = json.at("world").get<std::string>();
    s.world_hash = json.at("world_hash").get<std::uint64_t>();
    s.reading.inlines_when_needed = json.at("inlines_when_needed").get<bool>();
    s.reading.expansion = json.value("expansion", 1U);  // older captures have none
    s.reading.lenient = json.value("lenient", false);   // older captures have none
    s.reading.name = json.value("world_name", "");      // older captures have none
    s.reading.collide = json.value("collide", "");      // older captures have none
    s.reading.unit = json.value("unit", "");            // older captures have none
    s.reading.up = json.value("up", "");                // older captures have none
    s.file = json.at("file").get<std::string>();
    s.configuration = json.at("configuration").get<std::string>();
  } catch (const nlohmann::json::exception& e) {
    return std::unexpected(std::string("what the peer was made of can't be read: ") + e.what());
  }
  if (s.options.sample_hz == 0) return std::unexpected("sample_hz is 0");
  return s;
}

}  // namespace peerd::record
