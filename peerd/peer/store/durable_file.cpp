#include "peerd/peer/store/durable_file.hpp"

#include <string>
#include <system_error>

#include "peerd/input/text_file.hpp"
#include "peerd/peer/store/synchronise.hpp"

namespace peerd::store {

Result<void> write_durably(const std::filesystem::path& file, std::string_view bytes) {
  const std::string unfinished = file.string() + ".new";
  if (auto written = write_text_file(unfinished, bytes); !written) return written;
  if (const auto failed = put_in_place(unfinished, file)) {
    return std::unexpected(
        InputError{"error: " + file.string() + " cannot be written: " + failed.message(), kSystemFailed});
  }
  return {};
}

}  // namespace peerd::store
