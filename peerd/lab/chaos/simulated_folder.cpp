#include "peerd/lab/chaos/simulated_folder.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <utility>

#include <spdlog/fmt/fmt.h>

namespace peerd::chaos {
namespace {

using FileRef = SimulatedDisk::FileRef;

// The longest path that SQLite may ask for.
constexpr int kPathMax_bytes = 512;
// What SQLite's own file system says of a usual disk (os_unix.c).
constexpr int kSector_bytes = 4096;

// A file that SQLite has opened. SQLite gives the memory, and reads the methods at its begin.
struct OpenFile {
  sqlite3_file methods;
  SimulatedDisk* disk;
  FileRef file;
  bool keeps_name;  // its first synchronisation keeps its name, too, as that of a journal does on Linux
};

OpenFile& open_file(sqlite3_file* file) { return *reinterpret_cast<OpenFile*>(file); }
SimulatedDisk& disk_of(sqlite3_vfs* vfs) { return *static_cast<SimulatedDisk*>(vfs->pAppData); }

std::string_view name_in(const char* path) {
  const std::string_view whole(path);
  return whole.substr(whole.rfind('/') + 1);
}

// SQLite's code of an error, or `otherwise`.
int code_of(const std::error_code& error, int otherwise) {
  if (!error) return SQLITE_OK;
  return error == std::errc::no_space_on_device ? SQLITE_FULL : otherwise;
}

int close(sqlite3_file* file) {
  std::destroy_at(&open_file(file).file);
  return SQLITE_OK;
}

int read(sqlite3_file* file, void* to, int bytes, sqlite3_int64 at) {
  const OpenFile& open = open_file(file);
  const auto size = static_cast<std::size_t>(bytes);
  const auto got = open.disk->read(*open.file, static_cast<std::uint64_t>(at), size);
  if (!got) return SQLITE_IOERR_READ;
  std::ranges::copy(*got, static_cast<char*>(to));
  if (got->size() == size) return SQLITE_OK;
  std::memset(static_cast<char*>(to) + got->size(), 0, size - got->size());
  return SQLITE_IOERR_SHORT_READ;
}

int write(sqlite3_file* file, const void* from, int bytes, sqlite3_int64 at) {
  const OpenFile& open = open_file(file);
  const std::span content(static_cast<const char*>(from), static_cast<std::size_t>(bytes));
  return code_of(open.disk->write(*open.file, static_cast<std::uint64_t>(at), content), SQLITE_IOERR_WRITE);
}

int truncate(sqlite3_file* file, sqlite3_int64 bytes) {
  const OpenFile& open = open_file(file);
  return code_of(open.disk->truncate(*open.file, static_cast<std::uint64_t>(bytes)), SQLITE_IOERR_TRUNCATE);
}

int synchronise(sqlite3_file* file, int /*flags*/) {
  OpenFile& open = open_file(file);
  if (const auto failed = open.disk->synchronise(*open.file)) return code_of(failed, SQLITE_IOERR_FSYNC);
  if (!open.keeps_name) return SQLITE_OK;
  const auto failed = open.disk->synchronise_names();
  open.keeps_name = static_cast<bool>(failed);
  return code_of(failed, SQLITE_IOERR_DIR_FSYNC);
}

int file_size(sqlite3_file* file, sqlite3_int64* bytes) {
  const OpenFile& open = open_file(file);
  const auto size = open.disk->size(*open.file);
  if (!size) return SQLITE_IOERR_FSTAT;
  *bytes = static_cast<sqlite3_int64>(*size);
  return SQLITE_OK;
}

// One process has the disk.
int lock(sqlite3_file* /*file*/, int /*kind*/) { return SQLITE_OK; }
int is_reserved(sqlite3_file* /*file*/, int* reserved) {
  *reserved = 0;
  return SQLITE_OK;
}
int control(sqlite3_file* /*file*/, int /*operation*/, void* /*argument*/) { return SQLITE_NOTFOUND; }
int sector_size(sqlite3_file* /*file*/) { return kSector_bytes; }
int characteristics(sqlite3_file* /*file*/) { return SQLITE_IOCAP_POWERSAFE_OVERWRITE; }

constexpr sqlite3_io_methods kMethods{.iVersion = 1,
                                      .xClose = close,
                                      .xRead = read,
                                      .xWrite = write,
                                      .xTruncate = truncate,
                                      .xSync = synchronise,
                                      .xFileSize = file_size,
                                      .xLock = lock,
                                      .xUnlock = lock,
                                      .xCheckReservedLock = is_reserved,
                                      .xFileControl = control,
                                      .xSectorSize = sector_size,
                                      .xDeviceCharacteristics = characteristics,
                                      .xShmMap = nullptr,
                                      .xShmLock = nullptr,
                                      .xShmBarrier = nullptr,
                                      .xShmUnmap = nullptr,
                                      .xFetch = nullptr,
                                      .xUnfetch = nullptr};

int open(sqlite3_vfs* vfs, const char* path, sqlite3_file* file, int flags, int* opened_flags) {
  SimulatedDisk& disk = disk_of(vfs);
  file->pMethods = nullptr;  // not to be closed
  if (disk.is_dead()) return SQLITE_CANTOPEN;
  FileRef found = path == nullptr ? SimulatedDisk::make_nameless() : disk.find(name_in(path));
  bool is_new = false;
  if (!found) {
    if ((flags & SQLITE_OPEN_CREATE) == 0) return SQLITE_CANTOPEN;
    const auto made = disk.make(name_in(path));
    if (!made) return code_of(made.error(), SQLITE_CANTOPEN);
    found = *made;
    is_new = true;
  }
  const bool is_journal = (flags & (SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL | SQLITE_OPEN_WAL)) != 0;
  auto* const open = new (file) OpenFile{{&kMethods}, &disk, std::move(found), is_new && is_journal};
  assert(open->file);
  if (opened_flags != nullptr) *opened_flags = flags;
  return SQLITE_OK;
}

int remove(sqlite3_vfs* vfs, const char* path, int keeps_names) {
  SimulatedDisk& disk = disk_of(vfs);
  if (const auto failed = disk.remove(name_in(path))) return code_of(failed, SQLITE_IOERR_DELETE);
  return keeps_names == 0 ? SQLITE_OK : code_of(disk.synchronise_names(), SQLITE_IOERR_DIR_FSYNC);
}

// An empty file counts as none, as on Unix.
int access(sqlite3_vfs* vfs, const char* path, int flags, int* result) {
  const SimulatedDisk& disk = disk_of(vfs);
  const FileRef file = disk.find(name_in(path));
  const auto size = file ? disk.size(*file) : 0;
  if (!size) return SQLITE_IOERR_ACCESS;
  *result = file && (flags != SQLITE_ACCESS_EXISTS || *size > 0) ? 1 : 0;
  return SQLITE_OK;
}

int full_path(sqlite3_vfs* /*vfs*/, const char* path, int most, char* to) {
  const std::size_t size = std::strlen(path) + 1;
  if (size > static_cast<std::size_t>(most)) return SQLITE_CANTOPEN;
  std::memcpy(to, path, size);
  return SQLITE_OK;
}

// The system's would make two runs of one seed differ.
int randomness(sqlite3_vfs* /*vfs*/, int bytes, char* to) {
  std::memset(to, 0, static_cast<std::size_t>(bytes));
  return bytes;
}
int sleep(sqlite3_vfs* /*vfs*/, int microseconds) { return microseconds; }
int current_time(sqlite3_vfs* /*vfs*/, double* julian_day) {
  *julian_day = 0.0;
  return SQLITE_OK;
}
int last_error(sqlite3_vfs* /*vfs*/, int /*bytes*/, char* /*text*/) { return 0; }

}  // namespace

SimulatedFileSystem::SimulatedFileSystem(SimulatedDisk& disk)
    : disk_(disk), name_(fmt::format("simulated-{}", fmt::ptr(this))), vfs_(std::make_unique<sqlite3_vfs>()) {
  vfs_->iVersion = 1;
  vfs_->szOsFile = sizeof(OpenFile);
  vfs_->mxPathname = kPathMax_bytes;
  vfs_->zName = name_.c_str();
  vfs_->pAppData = &disk_;
  vfs_->xOpen = open;
  vfs_->xDelete = remove;
  vfs_->xAccess = access;
  vfs_->xFullPathname = full_path;
  vfs_->xRandomness = randomness;
  vfs_->xSleep = sleep;
  vfs_->xCurrentTime = current_time;
  vfs_->xGetLastError = last_error;
  [[maybe_unused]] const int code = sqlite3_vfs_register(vfs_.get(), 0);
  assert(code == SQLITE_OK);
}

SimulatedFileSystem::~SimulatedFileSystem() { sqlite3_vfs_unregister(vfs_.get()); }

std::expected<FileRef, std::error_code> SimulatedFolder::existing(std::string_view name) const {
  FileRef file = disk().find(name);
  if (!file) return std::unexpected(std::make_error_code(std::errc::no_such_file_or_directory));
  return file;
}

std::expected<std::optional<std::uint64_t>, std::error_code> SimulatedFolder::size(std::string_view name) const {
  const FileRef file = disk().find(name);
  if (!file) return std::nullopt;
  return disk().size(*file);
}

std::expected<std::string, std::error_code> SimulatedFolder::read(std::string_view name, std::size_t most) const {
  const auto file = existing(name);
  if (!file) return std::unexpected(file.error());
  const auto bytes = disk().read(**file, 0, most);
  if (!bytes) return std::unexpected(bytes.error());
  return std::string(bytes->begin(), bytes->end());
}

std::expected<std::string, std::error_code> SimulatedFolder::identity(std::string_view name) const {
  const auto file = existing(name);
  if (!file) return std::unexpected(file.error());
  return fmt::format("{}", disk().serial(**file));
}

std::error_code SimulatedFolder::write(std::string_view name, std::string_view bytes) {
  FileRef file = disk().find(name);
  if (file) {
    if (const auto failed = disk().truncate(*file, 0)) return failed;
  } else {
    auto made = disk().make(name);
    if (!made) return made.error();
    file = *std::move(made);
  }
  return disk().write(*file, 0, bytes);
}

std::error_code SimulatedFolder::put_in_place(std::string_view unfinished, std::string_view name) {
  const auto file = existing(unfinished);
  if (!file) return file.error();
  if (const auto failed = disk().synchronise(**file)) return failed;
  if (const auto failed = disk().rename(unfinished, name)) return failed;
  return disk().synchronise_names();
}

std::error_code SimulatedFolder::remove(std::string_view name) { return disk().remove(name); }

std::error_code SimulatedFolder::synchronise() { return disk().synchronise_names(); }

}  // namespace peerd::chaos
