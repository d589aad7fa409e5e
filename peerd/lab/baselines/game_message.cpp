#include "peerd/lab/baselines/game_message.hpp"

#include <algorithm>
#include <cmath>

namespace peerd::baselines {
namespace {

using replication::BitReader;
using replication::BitWriter;
using replication::put_varint;
using replication::take_varint;

constexpr std::uint32_t kCommandsMax = 16;
constexpr double kNormalSteps = 32767.0;

}  // namespace

std::size_t write(const ClientMessage& message, SimTime start, std::span<std::byte> out) {
  BitWriter writer(out);
  put_varint(writer, message.player);
  put_varint(writer, message.first_tick);
  put_varint(writer, message.commands.size());
  for (const Command& command : message.commands) put(writer, command);
  put_varint(writer, message.last_event);
  replication::put_time(writer, start, message.seen);
  for (const std::uint64_t number : message.blocks) put_varint(writer, number);
  return writer.finish();
}

std::optional<ClientMessage> read_client_message(std::span<const std::byte> in, SimTime start,
                                                 std::span<const std::size_t> objects, std::size_t blocks) {
  BitReader reader(in);
  ClientMessage message;
  std::uint32_t count = 0;
  if (!take_varint(reader, message.player) || message.player >= objects.size()) return std::nullopt;
  if (!take_varint(reader, message.first_tick) || !take_varint(reader, count) || count > kCommandsMax)
    return std::nullopt;
  message.commands.resize(count);
  for (Command& command : message.commands) {
    if (!take(reader, objects[message.player], command)) return std::nullopt;
  }
  if (!take_varint(reader, message.last_event) || !replication::take_time(reader, start, message.seen))
    return std::nullopt;
  message.blocks.resize(blocks);
  for (std::uint64_t& number : message.blocks) {
    if (!take_varint(reader, number)) return std::nullopt;
  }
  if (!reader.good()) return std::nullopt;
  return message;
}

void put(BitWriter& out, SimTime start, const GameEvent& event) {
  const replication::ContactEvent& contact = event.contact;
  out.put(event.shared ? 1 : 0, 8);
  out.put(static_cast<std::uint64_t>(contact.type), 8);
  replication::put_time(out, start, contact.at);
  replication::put_object(out, contact.collider);
  replication::put_object(out, contact.collidee);
  for (const double component : contact.normal) {
    out.put(static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(component * kNormalSteps))), 16);
  }
}

bool take(BitReader& in, SimTime start, GameEvent& event) {
  replication::ContactEvent& contact = event.contact;
  event.shared = in.get(8) != 0;
  const std::uint64_t type = in.get(8);
  if (type > static_cast<std::uint64_t>(CollisionType::kAllPairs)) return false;
  contact.type = static_cast<CollisionType>(type);
  if (!replication::take_time(in, start, contact.at)) return false;
  if (!replication::take_object(in, contact.collider) || !replication::take_object(in, contact.collidee)) return false;
  for (double& component : contact.normal) {
    component = static_cast<std::int16_t>(static_cast<std::uint16_t>(in.get(16))) / kNormalSteps;
  }
  return true;
}

void put(BitWriter& out, const SnapshotHead& head) {
  put_varint(out, head.tick);
  put_varint(out, head.commands);
  put_varint(out, head.block);
  put_varint(out, head.number);
  put_varint(out, head.number - head.base);
}

bool take(BitReader& in, SnapshotHead& head) {
  std::uint64_t back = 0;
  if (!take_varint(in, head.tick) || !take_varint(in, head.commands) || !take_varint(in, head.block)) return false;
  if (!take_varint(in, head.number) || !take_varint(in, back) || back > head.number) return false;
  head.base = head.number - back;
  return true;
}

}  // namespace peerd::baselines
