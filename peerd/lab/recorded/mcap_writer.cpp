#include "peerd/lab/recorded/mcap_writer.hpp"

#include <algorithm>
#include <cassert>
#include <ostream>
#include <utility>

#include <zlib.h>

#include "peerd/input/compression.hpp"

namespace peerd {
namespace {

// A record is its opcode, the length of its content in 8 bytes, and its content. Numbers are little endian; texts and
// lists begin with their length in 4 bytes.
enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
constexpr const char* kCompression = "zstd";

template <class T>
void number(std::string& out, T value) {
  for (std::size_t i = 0; i < sizeof value; ++i) out += static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i);
}

void text(std::string& out, std::string_view value) {
  number(out, static_cast<std::uint32_t>(value.size()));
  out += value;
}

std::string record_of(Opcode opcode, std::string_view content) {
  std::string out(1, static_cast<char>(opcode));
  number(out, static_cast<std::uint64_t>(content.size()));
  return out += content;
}

std::uint32_t crc_of(std::string_view bytes) {
  std::uint32_t crc = 0;
  while (!bytes.empty()) {  // zlib takes 32 bits of length
    const std::string_view part = bytes.substr(0, std::size_t{1} << 30);
    crc = static_cast<std::uint32_t>(
        crc32(crc, reinterpret_cast<const Bytef*>(part.data()), static_cast<uInt>(part.size())));
    bytes.remove_prefix(part.size());
  }
  return crc;
}

}  // namespace

McapWriter::McapWriter(std::ostream& out) : out_(out) {
  std::string header;
  text(header, "");  // no profile
  text(header, "peerd");
  put(kMcapMagic);
  put(record_of(Opcode::kHeader, header));
}

void McapWriter::put(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding, const std::string& data) {
  std::string content;
  number(content, ++schema_count_);
  text(content, name);
  text(content, encoding);
  text(content, data);
  const std::string schema = record_of(Opcode::kSchema, content);
  schemas_ += schema;
  chunk_.records += schema;
  return schema_count_;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, const std::string& topic, const std::string& encoding) {
  std::string content;
  number(content, ++channel_count_);
  number(content, schema);
  text(content, topic);
  text(content, encoding);
  number(content, std::uint32_t{0});  // no metadata
  const std::string channel = record_of(Opcode::kChannel, content);
  channels_ += channel;
  chunk_.records += channel;
  return channel_count_;
}

void McapWriter::add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view data) {
  assert(channel >= 1 && channel <= channel_count_);
  if (chunk_.index.empty()) chunk_.begin_ns = chunk_.end_ns = time_ns;
  chunk_.begin_ns = std::min(chunk_.begin_ns, time_ns);
  chunk_.end_ns = std::max(chunk_.end_ns, time_ns);
  begin_ns_ = messages_ == 0 ? time_ns : std::min(begin_ns_, time_ns);
  end_ns_ = std::max(end_ns_, time_ns);
  chunk_.index[channel].emplace_back(time_ns, chunk_.records.size());
  std::string content;
  number(content, channel);
  number(content, static_cast<std::uint32_t>(messages_of_[channel]++));
  number(content, time_ns);  // when it was logged
  number(content, time_ns);  // when it was published
  content += data;
  chunk_.records += record_of(Opcode::kMessage, content);
  ++messages_;
  if (chunk_.records.size() >= kChunk_bytes) close_chunk();
}

void McapWriter::close_chunk() {
  if (chunk_.records.empty()) return;
  const std::string packed = compress(chunk_.records);
  std::string content;
  number(content, chunk_.begin_ns);
  number(content, chunk_.end_ns);
  number(content, static_cast<std::uint64_t>(chunk_.records.size()));
  number(content, crc_of(chunk_.records));
  text(content, kCompression);
  number(content, static_cast<std::uint64_t>(packed.size()));
  content += packed;
  const std::uint64_t chunk_at = at_;
  put(record_of(Opcode::kChunk, content));
  const std::uint64_t chunk_length = at_ - chunk_at;

  std::string offsets;
  for (const auto& [channel, messages] : chunk_.index) {
    number(offsets, channel);
    number(offsets, at_);
    std::string index;
    number(index, channel);
    number(index, static_cast<std::uint32_t>(messages.size() * 2 * sizeof(std::uint64_t)));
    for (const auto& [time_ns, offset] : messages) {
      number(index, time_ns);
      number(index, offset);
    }
    put(record_of(Opcode::kMessageIndex, index));
  }
  std::string entry;
  number(entry, chunk_.begin_ns);
  number(entry, chunk_.end_ns);
  number(entry, chunk_at);
  number(entry, chunk_length);
  text(entry, offsets);
  number(entry, at_ - chunk_at - chunk_length);
  text(entry, kCompression);
  number(entry, static_cast<std::uint64_t>(packed.size()));
  number(entry, static_cast<std::uint64_t>(chunk_.records.size()));
  chunk_indexes_ += record_of(Opcode::kChunkIndex, entry);
  ++chunk_count_;
  chunk_ = {};
}

std::string McapWriter::statistics() const {
  std::string content;
  number(content, messages_);
  number(content, schema_count_);
  number(content, static_cast<std::uint32_t>(channel_count_));
  number(content, std::uint32_t{0});  // attachments
  number(content, std::uint32_t{0});  // metadata
  number(content, chunk_count_);
  number(content, begin_ns_);
  number(content, end_ns_);
  std::string counts;
  for (const auto& [channel, count] : messages_of_) {
    number(counts, channel);
    number(counts, count);
  }
  text(content, counts);
  return record_of(Opcode::kStatistics, content);
}

// The summary's groups of records, then where each group is. The footer's checksum is of all that, and of itself up to
// there.
void McapWriter::put_summary() {
  const std::uint64_t summary_at = at_;
  std::string summary, offsets;
  const auto add = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    std::string group(1, static_cast<char>(opcode));
    number(group, summary_at + summary.size());
    number(group, static_cast<std::uint64_t>(records.size()));
    offsets += record_of(Opcode::kSummaryOffset, group);
    summary += records;
  };
  add(Opcode::kSchema, schemas_);
  add(Opcode::kChannel, channels_);
  add(Opcode::kStatistics, statistics());
  add(Opcode::kChunkIndex, chunk_indexes_);
  std::string footer;
  number(footer, summary_at);
  number(footer, summary_at + summary.size());
  constexpr std::uint64_t kFooter_bytes = 20;
  std::string head(1, static_cast<char>(Opcode::kFooter));
  number(head, kFooter_bytes);
  number(footer, crc_of(summary + offsets + head + footer));
  assert(footer.size() == kFooter_bytes);
  put(summary);
  put(offsets);
  put(record_of(Opcode::kFooter, footer));
}

void McapWriter::finish() {
  close_chunk();
  std::string data_end;
  number(data_end, std::uint32_t{0});  // no checksum of all data: each chunk has one
  put(record_of(Opcode::kDataEnd, data_end));
  put_summary();
  put(kMcapMagic);
}

}  // namespace peerd
