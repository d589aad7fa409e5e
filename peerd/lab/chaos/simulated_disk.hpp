#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "peerd/lab/chaos/random_stream.hpp"

namespace peerd::chaos {

// The disk of one simulated computer, with one folder. A process sees what it has written; a power cut leaves what was
// synchronised, and of the rest any sectors and the first name changes.
class SimulatedDisk {
 public:
  class File;
  using FileRef = std::shared_ptr<File>;
  template <class T>
  using Result = std::expected<T, std::error_code>;

  static constexpr std::size_t kSector_bytes = 512;

  explicit SimulatedDisk(Random random) : random_(random) {}

  // ---- what can fail

  // The process that uses the disk ends with the `writes`-th change from now on, which may be done in part: everything
  // fails from then on, until revive(). None: it does not.
  void die_at_write(std::optional<std::uint64_t> writes) { dies_in_ = writes; }
  // The process has ended.
  void die() { is_dead_ = true; }
  [[nodiscard]] bool is_dead() const { return is_dead_; }
  // A next process begins. After a power cut it finds what the disk had.
  void revive(bool power_was_cut);
  // So many bytes fit yet; none: all do.
  void set_room(std::optional<std::uint64_t> bytes);
  // The probability that a change fails and does nothing.
  void set_error_rate(double rate) { error_rate_ = rate; }

  struct Counters {
    std::uint64_t writes = 0, synchronised = 0, torn = 0, lost = 0, refused_full = 0, refused_error = 0;
  };
  // `torn`: changes of which a process's end has left a part; `lost`: changes of which a power cut has.
  [[nodiscard]] const Counters& counters() const { return counters_; }

  // ---- files

  // Null: there is none.
  [[nodiscard]] FileRef find(std::string_view name) const;
  [[nodiscard]] Result<FileRef> make(std::string_view name);
  [[nodiscard]] static FileRef make_nameless();
  [[nodiscard]] Result<std::span<const char>> read(const File& file, std::uint64_t at, std::size_t bytes) const;
  [[nodiscard]] Result<std::uint64_t> size(const File& file) const;
  [[nodiscard]] std::uint64_t serial(const File& file) const;
  [[nodiscard]] std::error_code write(File& file, std::uint64_t at, std::span<const char> bytes);
  [[nodiscard]] std::error_code truncate(File& file, std::uint64_t bytes);
  [[nodiscard]] std::error_code synchronise(File& file);
  [[nodiscard]] std::error_code rename(std::string_view from, std::string_view to);
  [[nodiscard]] std::error_code remove(std::string_view name);
  [[nodiscard]] std::error_code synchronise_names();

 private:
  struct NameChange {
    std::string name;
    FileRef file;          // null: the name is gone
    std::string old_name;  // of the file that is renamed; else empty
  };
  using Names = std::map<std::string, FileRef, std::less<>>;

  // Whether a change may be made now, and whether the process ends with it.
  struct Leave {
    std::error_code refused;
    bool dies = false;
  };
  [[nodiscard]] Leave begin_change();
  [[nodiscard]] std::error_code change(NameChange change);
  static void apply(const NameChange& change, Names& names);
  void lose(File& file);
  [[nodiscard]] std::uint64_t used() const;

  Random random_;
  Names names_, durable_names_;
  std::vector<NameChange> name_changes_;  // since the names were synchronised
  std::uint64_t last_serial_ = 0;
  std::optional<std::uint64_t> dies_in_, capacity_;
  double error_rate_ = 0.0;
  bool is_dead_ = false;
  Counters counters_;
};

}  // namespace peerd::chaos
