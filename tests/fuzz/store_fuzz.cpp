// Opens a store of edits whose files are anything: it says in one sentence what is wrong and leaves them as they are,
// or holds logs that a peer can go on with. The first byte says what the rest is:
//
//   0  the whole file operations.sqlite
//   1  rows of a good one, each: author (1 byte), bytes that it begins before or after the end of its log (1 byte,
//      signed), flags (1 byte), length of its part of the log (2 bytes, low byte first), which follows
//   2  the file `author` beside a good operations.sqlite
//   3  the file world.json
//   4  the file `peer`
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "peerd/input/compression.hpp"
#include "peerd/lab/chaos/simulated_folder.hpp"
#include "peerd/peer/store/author_file.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/part_row.hpp"
#include "peerd/peer/store/stored_world.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace peerd;
using fuzz::require;
using namespace peerd::store;
using replication::AuthorId;

constexpr std::uint64_t kWorld = 0xFEED;
constexpr AuthorId kOwn{7};
constexpr const char* kFile = "operations.sqlite";
// Flags of a row: it is packed; its checksum is wrong; what it holds is not compressed; it says that it has kHugeSize
// bytes.
constexpr unsigned kPacked = 1, kWrongSum = 2, kNoFrame = 4, kHuge = 8;
constexpr std::int64_t kHugeSize = std::int64_t{1} << 62;

// The disk of a computer on which one store stands.
class Disk {
 public:
  [[nodiscard]] std::unique_ptr<FileFolder> folder() const {
    return std::make_unique<chaos::SimulatedFolder>(files_, "store");
  }
  void write(std::string_view name, std::string_view bytes) const { require(!folder()->write(name, bytes)); }
  [[nodiscard]] std::string read(std::string_view name) const {
    return folder()->read(name, std::size_t{1} << 30).value_or("");
  }
  [[nodiscard]] Result<std::unique_ptr<OperationStore>> open() const {
    return OperationStore::open(folder(), kWorld, {kOwn});
  }

 private:
  chaos::SimulatedDisk disk_{chaos::Random(1, 1)};
  chaos::SimulatedFileSystem files_{disk_};
};

// Opens what is there. What it holds is what a peer's logs take, each log from its beginning.
void check(const Disk& disk, const char* file) {
  const std::string before = disk.read(file);
  const auto store = disk.open();
  if (!store) {
    require(!store.error().text.empty() && store.error().text.find('\n') == std::string::npos);
    require(disk.read(file) == before);
    return;
  }
  replication::OperationLogs logs;
  for (const replication::OperationPart& part : (*store)->log()) require(logs.restore(part).has_value());
  for (const StoredLog& log : (*store)->logs()) require(logs.whole(log.author) == log.bytes);
}

void insert_rows(const Disk& disk, std::string_view rest) {
  auto database = Database::open(*disk.folder(), kFile, false);
  require(database.has_value() && database->accept().has_value());
  std::map<std::uint8_t, std::int64_t> ends;
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(rest[at]); };
  while (rest.size() > 5) {
    const std::uint8_t author = byte(0), flags = byte(2);
    const auto moved = static_cast<std::int8_t>(byte(1));
    const std::size_t length = std::min<std::size_t>(rest.size() - 5, byte(3) | byte(4) << 8);
    const auto bytes = std::as_bytes(std::span(rest.substr(5, length)));
    const std::int64_t start = ends[author] + moved;
    const bool is_packed = (flags & kPacked) != 0;
    const std::string frame = is_packed && (flags & kNoFrame) == 0 ? compress(rest.substr(5, length)) : std::string();
    const auto kept = frame.empty() ? bytes : std::as_bytes(std::span(frame));
    auto insert = database->prepare(is_packed ? "INSERT OR IGNORE INTO packed VALUES (?, ?, ?, ?, ?)"
                                              : "INSERT OR IGNORE INTO parts VALUES (?, ?, ?, ?)");
    require(insert.has_value());
    int parameter = 0;
    insert->bind(parameter++, std::int64_t{author});
    insert->bind(parameter++, start);
    if (is_packed) insert->bind(parameter++, (flags & kHuge) != 0 ? kHugeSize : static_cast<std::int64_t>(length));
    const std::int64_t wrong_by = (flags & kWrongSum) != 0 ? 1 : 0;
    insert->bind(parameter++, part_checksum(AuthorId{author}, static_cast<std::uint64_t>(start), bytes) ^ wrong_by);
    insert->bind(parameter++, kept);
    require(insert->step().has_value());
    ends[author] = start + static_cast<std::int64_t>(length);
    rest.remove_prefix(5 + length);
  }
}

// A folder of this process on a real disk, for the files that no simulated one has.
class RealFolder {
 public:
  RealFolder() : path_(std::filesystem::temp_directory_path() / ("store_fuzz." + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  RealFolder(const RealFolder&) = delete;
  RealFolder& operator=(const RealFolder&) = delete;
  ~RealFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void write(const char* name, std::string_view bytes) const { std::ofstream(path_ / name, std::ios::binary) << bytes; }

 private:
  std::filesystem::path path_;
};

void check_description(const RealFolder& folder, std::string_view text) {
  folder.write("world.json", text);
  folder.write("world.archive", "");
  const auto world = read_world_of_store(folder.path());
  if (!world || !*world) return;
  require(write_world(folder.path(), **world).has_value());
  const auto again = read_world_of_store(folder.path());
  require(again.has_value() && *again == *world);
}

void check_peer(const RealFolder& folder, std::string_view text) {
  folder.write("peer", text);
  const auto id = identity_in(folder.path(), PeerId{9}, kOwn);
  require(!id || id->value != 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const RealFolder folder;
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 5 == 3) return check_description(folder, rest), 0;
  if (data[0] % 5 == 4) return check_peer(folder, rest), 0;
  const Disk disk;
  if (data[0] % 5 == 0) {
    disk.write(kFile, rest);
    return check(disk, kFile), 0;
  }
  require(disk.open().has_value());
  if (data[0] % 5 == 1) {
    insert_rows(disk, rest);
    return check(disk, kFile), 0;
  }
  disk.write(kAuthorFile, rest);
  check(disk, kAuthorFile);
  return 0;
}
