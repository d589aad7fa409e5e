#pragma once
#include <filesystem>
#include <iosfwd>
#include <string>

#include "peerd/input/world_file.hpp"

namespace peerd {

// `peerd store check DIR` reads all that a store of operations holds, and says so by author. Returns the exit code: 0
// good; 1 it is damaged; 2 there is none, or it is of another version; 3 it can't be read, or another process has it.
//
// With `json` it prints one object to `out`: {"store", "genesis", "author", "bytes", "operations", "logs": [{"author",
// "bytes", "operations", "last_stamp_s"}]}; the author is null where the next peer begins a log of its own.
struct StoreCheckOptions {
  std::filesystem::path folder;
  bool json = false;
};
[[nodiscard]] int run_store_check(const StoreCheckOptions& options, std::ostream& out);

// `peerd store export DIR [--world FILE]` writes what a store's operations have made of its world, as VRML, to a file
// or to `out`. Returns the exit code: as above, and 1 where the world has errors or can't be written as one text, 2
// where it is not that of the store, or the store keeps none and no file is named.
struct StoreExportOptions {
  std::filesystem::path folder;
  std::filesystem::path world;  // the file that the world began with; empty: what the store keeps of it
  WorldReading reading{};
  std::filesystem::path file;  // empty: `out`
};
[[nodiscard]] int run_store_export(const StoreExportOptions& options, std::ostream& out);

// `peerd store merge FROM INTO` adds the edits of one store to another one of the same world, which no peer has open:
// of one that was put aside because its line of descent is another one, too. Returns the exit code: as above, and 1
// where an author's edits differ in the two, or are not signed.
struct StoreMergeOptions {
  std::filesystem::path from, into;
};
[[nodiscard]] int run_store_merge(const StoreMergeOptions& options, std::ostream& out);

}  // namespace peerd
