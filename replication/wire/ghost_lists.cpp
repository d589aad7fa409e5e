#include "replication/wire/ghost_lists.hpp"

#include <bit>
#include <cassert>
#include <cmath>
#include <span>

#include "replication/wire/bit_stream.hpp"
#include "replication/wire/varint.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

constexpr std::size_t kQuestionMax_bytes = 3 * 5 + 1 + 2 * kGhostBuckets;
constexpr std::size_t kReportMax_bytes = 10 + 4;

std::string as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void put_instant(BitWriter& out, SimTime at) {
  assert(at.time_since_epoch() % kGhostGrid == Duration{0});
  out.put(static_cast<std::uint64_t>(at.time_since_epoch() / kGhostGrid) & 0xFF, 8);
}

bool take_instant(BitReader& in, SimTime near, SimTime& at) {
  const std::int64_t here = near.time_since_epoch() / kGhostGrid;
  const std::uint64_t difference = (in.get(8) - static_cast<std::uint64_t>(here)) & 0xFF;
  const std::int64_t ahead = static_cast<std::int64_t>(difference) - (difference >= 128 ? 256 : 0);
  at = SimTime{(here + ahead) * kGhostGrid};
  return in_range(at.time_since_epoch().count());
}

template <std::size_t Count>
void put_numbers(BitWriter& out, const std::array<std::uint16_t, Count>& numbers) {
  for (const std::uint16_t number : numbers) out.put(number, 16);
}

template <std::size_t Count>
void take_numbers(BitReader& in, std::array<std::uint16_t, Count>& numbers) {
  for (std::uint16_t& number : numbers) number = static_cast<std::uint16_t>(in.get(16));
}

bool is_at_end(const BitReader& in, std::string_view bytes) { return in.good() && in.size_bytes() == bytes.size(); }

}  // namespace

std::string packed(const GhostDigest& digest) {
  std::array<std::byte, 1 + 2 * kGhostGroups> bytes;
  BitWriter out(bytes);
  put_instant(out, digest.at);
  put_numbers(out, digest.groups);
  return as_text(std::span(bytes).first(out.finish()));
}

bool take_ghosts(std::string_view bytes, SimTime near, GhostDigest& digest) {
  BitReader in(std::as_bytes(std::span(bytes)));
  if (!take_instant(in, near, digest.at)) return false;
  take_numbers(in, digest.groups);
  return is_at_end(in, bytes);
}

std::string packed(const GhostQuestion& question) {
  assert(question.group < kGhostGroups);
  std::array<std::byte, kQuestionMax_bytes> bytes;
  BitWriter out(bytes);
  put_varint(out, question.owner.value);
  put_varint(out, question.region.value);
  put_instant(out, question.at);
  put_varint(out, question.group);
  put_numbers(out, question.buckets);
  return as_text(std::span(bytes).first(out.finish()));
}

bool take_ghosts(std::string_view bytes, SimTime near, GhostQuestion& question) {
  BitReader in(std::as_bytes(std::span(bytes)));
  if (!take_varint(in, question.owner.value) || question.owner == kNobody) return false;
  if (!take_varint(in, question.region.value) || !take_instant(in, near, question.at)) return false;
  if (!take_varint(in, question.group) || question.group >= kGhostGroups) return false;
  take_numbers(in, question.buckets);
  return is_at_end(in, bytes);
}

std::string packed(const std::vector<GhostReport>& reports) {
  assert(reports.size() <= kGhostReportsMax);
  std::array<std::byte, kGhostReportsMax * kReportMax_bytes> bytes;
  BitWriter out(bytes);
  for (const GhostReport& report : reports) {
    put_object(out, report.object);
    out.put(std::bit_cast<std::uint32_t>(report.distance_m), 32);
  }
  return as_text(std::span(bytes).first(out.finish()));
}

bool take_ghosts(std::string_view bytes, std::vector<GhostReport>& reports) {
  BitReader in(std::as_bytes(std::span(bytes)));
  while (in.size_bytes() < bytes.size()) {
    if (reports.size() == kGhostReportsMax) return false;
    GhostReport& report = reports.emplace_back();
    if (!take_object(in, report.object)) return false;
    report.distance_m = std::bit_cast<float>(static_cast<std::uint32_t>(in.get(32)));
    if (!in.good() || !(report.distance_m >= 0.0f) || !std::isfinite(report.distance_m)) return false;
  }
  return true;
}

}  // namespace peerd::replication
