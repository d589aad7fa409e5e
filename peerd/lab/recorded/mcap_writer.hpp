#pragma once
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace peerd {

// Writes an MCAP file (https://mcap.dev/spec, version 0): messages of channels in chunks that are packed by zstd and
// indexed, and at the end a summary by which a reader seeks. Whether the stream took everything is asked of the stream.
class McapWriter {
 public:
  // Begins the file. The stream is at its begin, and outlives the writer.
  explicit McapWriter(std::ostream& out);

  // `encoding`: of the schema, such as "jsonschema".
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& data);
  // `encoding`: of the messages, such as "json".
  std::uint16_t add_channel(std::uint16_t schema, const std::string& topic, const std::string& encoding);
  void add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view data);
  // Ends the file. Nothing is added afterwards.
  void finish();

  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t size_bytes() const { return at_; }

 private:
  static constexpr std::size_t kChunk_bytes = std::size_t{1} << 20;

  struct Chunk {
    std::string records;
    std::uint64_t begin_ns = 0, end_ns = 0;
    // The index has of each channel the times of its messages, and where they begin in the records.
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index;
  };

  void put(std::string_view bytes);
  void close_chunk();
  std::string statistics() const;
  void put_summary();

  std::ostream& out_;
  std::uint64_t at_ = 0;  // bytes written
  Chunk chunk_;
  std::string schemas_, channels_, chunk_indexes_;  // records of the summary
  std::uint16_t schema_count_ = 0, channel_count_ = 0;
  std::uint32_t chunk_count_ = 0;
  std::uint64_t messages_ = 0, begin_ns_ = 0, end_ns_ = 0;
  std::map<std::uint16_t, std::uint64_t> messages_of_;  // by channel
};

}  // namespace peerd
